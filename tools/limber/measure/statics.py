"""What the statics of an impedance law predict at the tip, and how far friction can hide it.

At rest the law's torque, the push F and all other joint torque τ (friction, null space) balance:
    Cartesian impedance   Jᵀ K_x J Δq = Jᵀ F + τ
    joint impedance            K_q Δq = Jᵀ F + τ
so the tip moves by Δx = G (Jᵀ F + τ) with G = J (Jᵀ K_x J)⁺ or G = J K_q⁻¹, and its compliance is
C = G Jᵀ. For six or more joints under Cartesian impedance that is K_x⁻¹.
(Salisbury, "Active stiffness control of a manipulator in Cartesian coordinates", 1980.)

Two motors a joint (variable_stiffness): the springs σ are the law, the motors stand still, and the
weight g changes as the joints bend:      (diag σ + ∂g/∂q) Δq = Jᵀ F + τ
"""

import numpy as np

from limber.arrays import Floats
from limber.model.robot import SpringPair

CARTESIAN = "cartesian_impedance"
JOINT = "joint_pd"
SPRINGS = "variable_stiffness"


def tip_response(law: str, J: Floats, K_x: Floats, K_q: Floats) -> Floats | None:
    """G, 6xn: tip displacement per joint torque; None for laws that hold no pose."""
    if law == JOINT:
        return J / K_q
    if law == CARTESIAN:
        return J @ np.linalg.pinv(J.T @ K_x @ J, rcond=1e-9, hermitian=True)
    return None


def springs_fitted(J: Floats, K_x: Floats, weight: Floats, pairs: list[SpringPair]) -> Floats:
    """σ, N m/rad: the diagonal nearest to Jᵀ K_x J that two quadratic springs a joint can give.

    Both springs pull while σ² >= 2 k2 |τ| for the torque τ that the joint carries, here its weight.
    """
    k2 = np.array([pair.k2_Nm_per_rad2 for pair in pairs])
    most = 2.0 * k2 * np.array([pair.preload_max_rad for pair in pairs])
    return np.clip(np.diag(J.T @ K_x @ J), np.sqrt(2.0 * k2 * np.abs(weight)), most)


def springs_response(J: Floats, sigma: Floats, weight_slope: Floats) -> Floats:
    """G, 6xn, of springs σ in the joints; `weight_slope` is ∂g/∂q, N m/rad."""
    return J @ np.linalg.inv(np.diag(sigma) + weight_slope)


def stiffness_along(C: Floats, direction: Floats) -> float:
    """Force per displacement along a unit direction (force or torque), the others being free."""
    return float(1.0 / (direction @ C @ direction))


def force_of_torque(G: Floats, C: Floats, direction: Floats, torque: Floats) -> float:
    """The push along a direction that moves the tip as far along it as these joint torques do."""
    return float(direction @ G @ torque) * stiffness_along(C, direction)


def greatest_friction_force(G: Floats, C: Floats, direction: Floats, friction: Floats) -> float:
    """How much of a push joint friction can hold: all joints' friction against it at once."""
    return float(np.abs(direction @ G) @ friction) * stiffness_along(C, direction)
