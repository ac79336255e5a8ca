"""Rotation errors, with scipy's rotations; no part of limber is used."""

import numpy as np
from scipy.spatial.transform import Rotation

from arms import cross


def left_jacobian(phi):
    angle = np.linalg.norm(phi)
    K = cross(phi)
    if angle < 1e-6:
        return np.eye(3) + K / 2
    a = (1 - np.cos(angle)) / angle**2
    b = (angle - np.sin(angle)) / angle**3
    return np.eye(3) + a * K + b * K @ K


def log_error(R, R_d):
    phi = Rotation.from_matrix(R @ R_d.T).as_rotvec()
    return phi, np.linalg.inv(left_jacobian(phi))


def quat_error(R, R_d):
    x, y, z, w = Rotation.from_matrix(R @ R_d.T).as_quat()
    sign = 1.0 if w >= 0 else -1.0
    epsilon = sign * np.array([x, y, z])
    return 2 * epsilon, sign * w * np.eye(3) - cross(epsilon)


def rpy_error(R, R_d):
    now = Rotation.from_matrix(R).as_euler("ZYX")[::-1]
    then = Rotation.from_matrix(R_d).as_euler("ZYX")[::-1]
    _, p, y = now
    T = np.array(
        [
            [np.cos(y) * np.cos(p), -np.sin(y), 0],
            [np.sin(y) * np.cos(p), np.cos(y), 0],
            [-np.sin(p), 0, 1],
        ]
    )
    return (now - then + np.pi) % (2 * np.pi) - np.pi, np.linalg.inv(T)


def error(mode, R, R_d):
    """e_o and A_o."""
    if mode == "rpy":
        return rpy_error(R, R_d)
    e, A = log_error(R, R_d) if mode.startswith("log") else quat_error(R, R_d)
    return e, np.eye(3) if mode.endswith("_simple") else A
