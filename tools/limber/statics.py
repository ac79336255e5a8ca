"""What the statics of an impedance law predict at the tip, and how far friction can hide it.

At rest the law's torque, the push and friction balance. With τ = -Jᵀ K_x e (Cartesian impedance) or
τ = -K_q (q - q_D) (joint impedance) a push F moves the tip by C F, where
    C = J (Jᵀ K_x J)⁺ Jᵀ   (K_x⁻¹ for six or more joints; what is left of it for fewer), or
    C = J K_q⁻¹ Jᵀ.
(Salisbury, "Active stiffness control of a manipulator in Cartesian coordinates", 1980.)
"""

import numpy as np

CARTESIAN = "cartesian_impedance"
JOINT = "joint_impedance"


def tip_compliance(law: str, J: np.ndarray, K_x: np.ndarray, K_q: np.ndarray) -> np.ndarray | None:
    """C, 6x6, m/N and rad/(N m); None for laws that hold no pose."""
    if law == JOINT:
        return J @ np.diag(1.0 / K_q) @ J.T
    if law == CARTESIAN:
        if J.shape[1] >= 6:
            return np.linalg.pinv(K_x, hermitian=True)
        return J @ np.linalg.pinv(J.T @ K_x @ J, hermitian=True) @ J.T
    return None


def stiffness_along(C: np.ndarray, direction: np.ndarray) -> float:
    """Force per displacement along a unit direction (force or torque), the others being free."""
    return float(1.0 / (direction @ C @ direction))


def friction_force(J: np.ndarray, friction: np.ndarray, direction: np.ndarray) -> float:
    """How much of a push along a unit direction joint friction can take: Σ |(J⁺ n)_i| τ_f,i.

    The joint motion that moves the tip by n does this much work against friction per m (or rad).
    """
    rows = J if J.shape[1] >= 6 else J[:3]
    n = direction if J.shape[1] >= 6 else direction[:3]
    return float(np.abs(np.linalg.pinv(rows) @ n) @ friction)
