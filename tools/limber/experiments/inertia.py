"""Inertia and gravity of a shipped robot, from its URDF, as sums over its links and without C++."""

from functools import cache

import numpy as np

from limber.model.bodies import Inertial, read_inertials
from limber.model.robot import load_robot
from limber.model.urdf import Chain


def joint_inertia(robot: str, q: np.ndarray) -> np.ndarray:
    """M(q) = Σ J_cᵀ diag(m, I_c) J_c with J_c at each link's centre of mass; base axes."""
    M = np.zeros((len(q), len(q)))
    for chain, link in _links(robot):
        J_c = _at_centre(chain, q, link.com)
        J_w, R = chain.jacobian(q)[3:], chain.forward(q)[:3, :3]
        moving = J_w.shape[1]
        M[:moving, :moving] += link.mass * J_c.T @ J_c + J_w.T @ R @ link.inertia @ R.T @ J_w
    return M


def gravity_gradient(robot: str, q: np.ndarray) -> np.ndarray:
    """∂g/∂q by central differences."""
    return np.column_stack([gravity_rate(robot, q, axis) for axis in np.eye(len(q))])


def gravity_rate(robot: str, q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """(∂g/∂q) v by a central difference; g(q) = -Σ m J_cᵀ a holds the arm against gravity a."""
    step = 1e-5
    return (_gravity(robot, q + step * v) - _gravity(robot, q - step * v)) / (2 * step)


def _gravity(robot: str, q: np.ndarray) -> np.ndarray:
    g = np.zeros(len(q))
    for chain, link in _links(robot):
        J_c = _at_centre(chain, q, link.com)
        g[: J_c.shape[1]] -= link.mass * J_c.T @ _acceleration(robot)
    return g


@cache
def _acceleration(robot: str) -> np.ndarray:
    return load_robot(robot).gravity


def _at_centre(chain: Chain, q: np.ndarray, p_LC: np.ndarray) -> np.ndarray:
    """Velocity of a link's centre of mass by the joints' before it."""
    J = chain.jacobian(q)
    return J[:3] + np.cross(J[3:], chain.forward(q)[:3, :3] @ p_LC, axis=0)


def tip_inertia(J: np.ndarray, M: np.ndarray) -> np.ndarray:
    """Λ = (J M⁻¹ Jᵀ)⁻¹."""
    return np.linalg.inv(J @ np.linalg.solve(M, J.T))


@cache
def _links(robot: str) -> list[tuple[Chain, Inertial]]:
    """Chain to each link that moves and has a mass, and its inertial."""
    loaded = load_robot(robot)
    return [
        (Chain(loaded.urdf, loaded.base, link), inertial)
        for link, inertial in read_inertials(loaded.urdf).items()
    ]
