"""The arm as it would stand with its tip at the goal: drawn translucent where it differs."""

import numpy as np

from limber.model import rotations
from limber.model.urdf import Chain

STEPS = 6
DAMPING = 0.03
LARGEST_STEP = 0.3  # rad or m
SEEN_M, SEEN_RAD = 0.004, 0.02  # below, the ghost would lie on the arm


def nearest_posture(
    chain: Chain, q: np.ndarray, p_BD: np.ndarray, quat_BD: np.ndarray
) -> np.ndarray:
    """Joint positions near `q` with the tip near the goal, by damped least squares; as near as a
    few steps get.
    """
    q = np.array(q, float)
    for _ in range(STEPS):
        X = chain.forward(q)
        turn = rotations.between(rotations.quaternion_of(X[:3, :3]), quat_BD)
        e = np.concatenate([p_BD - X[:3, 3], turn])
        if np.linalg.norm(e) < 1e-4:
            break
        J = chain.jacobian(q)
        step = J.T @ np.linalg.solve(J @ J.T + DAMPING**2 * np.eye(6), e)
        q += np.clip(step, -LARGEST_STEP, LARGEST_STEP)
    return q


def differs(p_BT: np.ndarray, quat_BT: np.ndarray, p_BD: np.ndarray, quat_BD: np.ndarray) -> bool:
    """True if the goal is away from the tip far enough to be drawn."""
    if not all(np.isfinite(part).all() for part in (p_BT, quat_BT, p_BD, quat_BD)):
        return False
    if np.linalg.norm(quat_BD) < 0.5 or np.linalg.norm(quat_BT) < 0.5:
        return False  # no pose yet
    turned = 2 * np.arccos(min(abs(float(quat_BT @ quat_BD)), 1.0))
    return bool(np.linalg.norm(p_BT - p_BD) > SEEN_M or turned > SEEN_RAD)
