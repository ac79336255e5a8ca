"""A closed turn of the hand against unequal rotational springs: does the spring give work away?

The moment goes around a rectangle: up about x, up about y, down about x, down about y. In the
other order the damper takes the same, but what the spring gives changes its sign: half of the
difference of the hand's work is the spring's alone, but for what lag adds. That goes with the
square of the speed, and two speeds tell it.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.optimize import root
from scipy.spatial.transform import Rotation

from limber.experiments.check import Check
from limber.experiments.context import Context
from limber.experiments.truth import motion, status

K_O = np.diag([10.0, 60.0, 30.0])  # N m/rad
SIDES = np.array([[9.0, 0.0, 0.0], [0.0, 45.0, 0.0]])  # N m
LEGS_S = (4.0, 8.0)  # how long a side takes: fast and slow
DAMPING_RATIO = 0.2
FIRST_AT, RESTS_S = 2.0, 3.5

Spring = Callable[[np.ndarray], np.ndarray]


def run_turns(context: Context, start_q: list[float], modes: list[str]) -> dict[str, float]:
    """Mode -> work that the spring takes from the hand in a turn, J."""
    return {mode: _net_work(context, start_q, mode) for mode in modes}


def checks(works: dict[str, float]) -> list[Check]:
    found = []
    for mode, work in works.items():
        predicted = turn_work(mode)
        name = f"work of a closed turn, {mode}"
        if mode in ("log", "quat"):
            found.append(Check(name, 0.0, work * 1e3, "mJ", 1.0, "absolute"))
        else:
            found.append(Check(name, predicted, work, "J", 0.01))
    return found


def turn_work(mode: str) -> float:
    """∮ μ·ω along the orientations that balance the moment, in small steps. Trapezoids."""
    share = np.linspace(0.0, 1.0, 401)[:, None]
    x, y = SIDES
    legs = [share * x, x + share * y, (1 - share) * x + y, (1 - share) * y]
    moments = np.concatenate(legs)
    poses = [np.zeros(3)]
    for moment in moments[1:]:
        poses.append(_balance(SPRINGS[mode], moment, poses[-1]))
    R = Rotation.from_rotvec(poses)
    steps = (R[1:] * R[:-1].inv()).as_rotvec()
    return float(np.sum((moments[1:] + moments[:-1]) / 2 * steps))


def _balance(spring: Spring, moment: np.ndarray, start: np.ndarray) -> np.ndarray:
    return root(lambda r: spring(r) - moment, start).x


def _log(r: np.ndarray) -> np.ndarray:
    return left_jacobian_inverse(r).T @ K_O @ r


def _quat(r: np.ndarray) -> np.ndarray:
    *epsilon, eta = Rotation.from_rotvec(r).as_quat(canonical=True)
    return (eta * np.eye(3) - cross(np.array(epsilon))).T @ K_O @ (2 * np.array(epsilon))


def _quat_simple(r: np.ndarray) -> np.ndarray:
    return K_O @ (2 * Rotation.from_rotvec(r).as_quat(canonical=True)[:3])


# Moment of the spring turned by the rotation vector r
SPRINGS: dict[str, Spring] = {
    "log": _log,
    "quat": _quat,
    "log_simple": lambda r: K_O @ r,
    "quat_simple": _quat_simple,
}


def cross(r: np.ndarray) -> np.ndarray:
    return np.cross(np.eye(3), r)


def left_jacobian_inverse(r: np.ndarray) -> np.ndarray:
    """ṙ = J_l⁻¹(r) ω."""
    angle, X = np.linalg.norm(r), cross(r)
    if angle < 1e-4:
        return np.eye(3) - X / 2 + X @ X / 12
    last = 1 / angle**2 - (1 + np.cos(angle)) / (2 * angle * np.sin(angle))
    return np.eye(3) - X / 2 + last * X @ X


def _net_work(context: Context, start_q: list[float], mode: str) -> float:
    """Of an infinitely slow turn."""
    fast, slow = (_half_difference(context, start_q, mode, leg_s) for leg_s in LEGS_S)
    return slow + (slow - fast) / ((LEGS_S[1] / LEGS_S[0]) ** 2 - 1)


def _half_difference(context: Context, start_q: list[float], mode: str, leg_s: float) -> float:
    turn_s = 4 * leg_s + RESTS_S
    starts = FIRST_AT, FIRST_AT + turn_s
    log = context.lab(_scenario(start_q, mode, leg_s, starts), f"turn_{mode}_{leg_s:g}s")
    hand = []
    for start in starts:
        status(log, start, start + turn_s)
        rows = motion(log, start, start + turn_s)
        hand.append(rows["work_external_J"][-1] - rows["work_external_J"][0])
    return float(hand[0] - hand[1]) / 2


def _scenario(
    start_q: list[float], mode: str, leg_s: float, starts: tuple[float, float]
) -> dict[str, Any]:
    """Two turns: about x first, then about y first."""
    gains = {
        "law": "cartesian_impedance",
        "orientation": mode,
        "K_x_rotation_Nm_per_rad": np.diag(K_O).tolist(),
        "damping_ratio": DAMPING_RATIO,
        "spring_force_N": 1000.0,
        "spring_moment_Nm": 1000.0,
    }
    pushes = []
    for start, order in zip(starts, (SIDES, SIDES[::-1]), strict=True):
        for i, moment in enumerate(order):
            push = {"torque_Nm": moment.tolist(), "ramp_s": leg_s, "for_s": 3 * leg_s, "id": i + 1}
            pushes.append({"at_s": start + i * leg_s, "push": push})
    return {
        "robot": "ideal7",
        "duration_s": starts[1] + 4 * leg_s + RESTS_S + 0.1,
        "integrator": "reference",
        "start_q": start_q,
        "timeline": [
            {"at_s": 0.3, "mode": "hold"},
            {"at_s": 0.8, "mode": "active"},
            {"at_s": 1.0, "gains": gains},
            *pushes,
        ],
    }
