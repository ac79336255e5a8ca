"""What the statics of an impedance law predict at the tip, and how far friction can hide it.

At rest the law's torque, the push F and all other joint torque τ (friction, null space) balance:
    Cartesian impedance   Jᵀ K_x J Δq = Jᵀ F + τ
    joint impedance            K_q Δq = Jᵀ F + τ
so the tip moves by Δx = G (Jᵀ F + τ) with G = J (Jᵀ K_x J)⁺ or G = J K_q⁻¹, and its compliance is
C = G Jᵀ. For six or more joints under Cartesian impedance that is K_x⁻¹.
(Salisbury, "Active stiffness control of a manipulator in Cartesian coordinates", 1980.)
"""

import numpy as np

CARTESIAN = "cartesian_impedance"
JOINT = "joint_pd"


def tip_response(law: str, J: np.ndarray, K_x: np.ndarray, K_q: np.ndarray) -> np.ndarray | None:
    """G, 6xn: tip displacement per joint torque; None for laws that hold no pose."""
    if law == JOINT:
        return J / K_q
    if law == CARTESIAN:
        return J @ np.linalg.pinv(J.T @ K_x @ J, rcond=1e-9, hermitian=True)
    return None


def stiffness_along(C: np.ndarray, direction: np.ndarray) -> float:
    """Force per displacement along a unit direction (force or torque), the others being free."""
    return float(1.0 / (direction @ C @ direction))


def force_of_torque(
    G: np.ndarray, C: np.ndarray, direction: np.ndarray, torque: np.ndarray
) -> float:
    """The push along a direction that moves the tip as far along it as these joint torques do."""
    return float(direction @ G @ torque) * stiffness_along(C, direction)


def greatest_friction_force(
    G: np.ndarray, C: np.ndarray, direction: np.ndarray, friction: np.ndarray
) -> float:
    """How much of a push joint friction can hold: all joints' friction against it at once."""
    return float(np.abs(direction @ G) @ friction) * stiffness_along(C, direction)
