"""Differences of orientations, and the derivatives of rotation vectors."""

import numpy as np
from scipy.spatial.transform import Rotation

from limber.arrays import Floats


def rotation_error(quat_BT: Floats, quat_BD: Floats) -> Floats:
    """Log(R_BT R_BDᵀ) of rows of quaternions w, x, y, z; rows without a pose give zero."""
    known = (np.linalg.norm(quat_BT, axis=1) > 0.5) & (np.linalg.norm(quat_BD, axis=1) > 0.5)
    vectors = np.zeros((len(quat_BT), 3))
    if known.any():
        R_BT = Rotation.from_quat(quat_BT[known], scalar_first=True)
        R_BD = Rotation.from_quat(quat_BD[known], scalar_first=True)
        vectors[known] = (R_BT * R_BD.inv()).as_rotvec()
    return vectors


def cross(r: Floats) -> Floats:
    """[r]×, so that cross(r) x is r × x."""
    return np.cross(np.eye(3), r)


def left_jacobian_inverse(r: Floats) -> Floats:
    """ṙ = J_l⁻¹(r) ω."""
    angle, X = float(np.linalg.norm(r)), cross(r)
    if angle < 1e-4:
        return np.eye(3) - X / 2 + X @ X / 12
    last = 1 / angle**2 - (1 + np.cos(angle)) / (2 * angle * np.sin(angle))
    inverse: Floats = np.eye(3) - X / 2 + last * X @ X
    return inverse
