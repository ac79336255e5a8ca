"""Inertia of a shipped robot, from its URDF and by the sum over its links, without the C++ chain."""

import xml.etree.ElementTree as ElementTree
from functools import cache

import numpy as np
from scipy.spatial.transform import Rotation

from limber.paths import robot_folder
from limber.robot import load_robot
from limber.urdf import Chain


def joint_inertia(robot: str, q: np.ndarray) -> np.ndarray:
    """M(q) = Σ J_cᵀ diag(m, I_c) J_c with J_c at each link's centre of mass; base axes."""
    M = np.zeros((len(q), len(q)))
    for chain, m, p_LC, I_C in _links(robot):
        X = chain.forward(q)
        J = chain.jacobian(q)
        moving = J.shape[1]
        at_centre = J[:3] + np.cross(J[3:], X[:3, :3] @ p_LC, axis=0)
        R = X[:3, :3]
        M[:moving, :moving] += m * at_centre.T @ at_centre + J[3:].T @ R @ I_C @ R.T @ J[3:]
    return M


def tip_inertia(robot: str, q: np.ndarray) -> np.ndarray:
    """Λ = (J M⁻¹ Jᵀ)⁻¹, 6 x 6."""
    J = tip_jacobian(robot, q)
    return np.linalg.inv(J @ np.linalg.solve(joint_inertia(robot, q), J.T))


def tip_jacobian(robot: str, q: np.ndarray) -> np.ndarray:
    return load_robot(robot).chain.jacobian(q)


@cache
def _links(robot: str) -> list[tuple[Chain, float, np.ndarray, np.ndarray]]:
    """Chain to each link that moves and weighs something, mass, centre, inertia about it."""
    loaded = load_robot(robot)
    found = []
    for link in ElementTree.parse(robot_folder(robot) / loaded.urdf.name).getroot().iter("link"):
        inertial = link.find("inertial")
        if inertial is None:
            continue
        chain = Chain(loaded.urdf, loaded.base, link.get("name"))
        origin = inertial.find("origin").attrib
        R = Rotation.from_euler("xyz", [float(x) for x in origin.get("rpy", "0 0 0").split()])
        axes = R.as_matrix()
        I = {key: float(value) for key, value in inertial.find("inertia").attrib.items()}
        about = np.array(
            [
                [I["ixx"], I["ixy"], I["ixz"]],
                [I["ixy"], I["iyy"], I["iyz"]],
                [I["ixz"], I["iyz"], I["izz"]],
            ]
        )
        centre = np.array([float(x) for x in origin.get("xyz", "0 0 0").split()])
        mass = float(inertial.find("mass").get("value"))
        found.append((chain, mass, centre, axes @ about @ axes.T))
    return found
