"""Inertia and gravity of a robot, shipped or a folder, from its URDF and without C++."""

from functools import cache

import numpy as np

from limber.model.dynamics import ArmDynamics
from limber.model.robot import load_robot


@cache
def dynamics(robot: str) -> ArmDynamics:
    return load_robot(robot).dynamics


def joint_inertia(robot: str, q: np.ndarray) -> np.ndarray:
    return dynamics(robot).inertia(q)


def gravity_gradient(robot: str, q: np.ndarray) -> np.ndarray:
    return dynamics(robot).gravity_slope(q)


def tip_inertia(J: np.ndarray, M: np.ndarray) -> np.ndarray:
    """Λ = (J M⁻¹ Jᵀ)⁻¹."""
    return np.linalg.inv(J @ np.linalg.solve(M, J.T))
