"""Rotations as matrices R, unit quaternions w, x, y, z, and vectors (axis times angle).

All functions take one rotation, or an array of them along the leading axes.
"""

import numpy as np

from limber.arrays import Floats


def matrix_of(quat: Floats) -> Floats:
    """R of quaternions of any length but zero."""
    unit = np.asarray(quat, float)
    unit = unit / np.linalg.norm(unit, axis=-1, keepdims=True)
    w, x, y, z = np.moveaxis(unit, -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def quaternion_of(R: Floats) -> Floats:
    """The eigenvector of Bar-Itzhack's matrix with the largest eigenvalue; w is not negative."""
    R = np.asarray(R, float)
    xx, yy, zz = R[..., 0, 0], R[..., 1, 1], R[..., 2, 2]
    K = np.zeros((*R.shape[:-2], 4, 4))
    K[..., 0, 0], K[..., 1, 1] = xx + yy + zz, xx - yy - zz
    K[..., 2, 2], K[..., 3, 3] = yy - xx - zz, zz - xx - yy
    for i, j, k in ((1, 2, 3), (2, 3, 1), (3, 1, 2)):
        K[..., 0, i] = K[..., i, 0] = R[..., k - 1, j - 1] - R[..., j - 1, k - 1]
        K[..., j, k] = K[..., k, j] = R[..., k - 1, j - 1] + R[..., j - 1, k - 1]
    quat = np.linalg.eigh(K)[1][..., :, -1]
    return np.where(quat[..., :1] < 0, -quat, quat)


def product(a: Floats, b: Floats) -> Floats:
    """Of two quaternions: the rotation b, then a."""
    w, x, y, z = (a[..., i] for i in range(4))
    W, X, Y, Z = (b[..., i] for i in range(4))
    parts = (
        w * W - x * X - y * Y - z * Z,
        w * X + x * W + y * Z - z * Y,
        w * Y + y * W + z * X - x * Z,
        w * Z + z * W + x * Y - y * X,
    )
    return np.stack(parts, axis=-1)


def between(a: Floats, b: Floats) -> Floats:
    """The rotation vector that turns quaternion a to b, Log(R_b R_aᵀ), in the axes that both are
    given in; its length is at most pi.
    """
    turn = product(np.asarray(b, float), np.asarray(a, float) * np.array([1.0, -1, -1, -1]))
    turn = np.where(turn[..., :1] < 0, -turn, turn)
    size = np.linalg.norm(turn[..., 1:], axis=-1, keepdims=True)
    angle = 2 * np.arctan2(size, turn[..., :1])
    return turn[..., 1:] * np.where(size > 0, angle / np.where(size > 0, size, 1.0), 2.0)


def quaternion_about(vector: Floats) -> Floats:
    """Quaternions of rotation vectors."""
    r = np.asarray(vector, float)
    half = 0.5 * np.linalg.norm(r, axis=-1, keepdims=True)
    quats: Floats = np.concatenate([np.cos(half), 0.5 * r * np.sinc(half / np.pi)], axis=-1)
    return quats


def turned_about(vector: Floats) -> Floats:
    """R of rotation vectors."""
    return matrix_of(quaternion_about(vector))


def mean(quats: Floats) -> Floats:
    """The quaternion nearest to all rows, in the sense of the largest sum of squared cosines."""
    unit = quats / np.linalg.norm(quats, axis=1, keepdims=True)
    return np.asarray(np.linalg.eigh(unit.T @ unit)[1][:, -1])


def from_z(direction: Floats) -> Floats:
    """The shortest quaternion that turns the z axis to a unit vector."""
    x, y, z = direction
    if z < -1 + 1e-12:
        return np.array([0.0, 1.0, 0.0, 0.0])
    quat: Floats = np.array([1 + z, -y, x, 0.0])
    quat /= np.linalg.norm(quat)
    return quat


def rotation_error(quat_BT: Floats, quat_BD: Floats) -> Floats:
    """Log(R_BT R_BDᵀ) of rows of quaternions; rows without a pose give zero."""
    known = (np.linalg.norm(quat_BT, axis=1) > 0.5) & (np.linalg.norm(quat_BD, axis=1) > 0.5)
    vectors = np.zeros((len(quat_BT), 3))
    if known.any():
        vectors[known] = between(quat_BD[known], quat_BT[known])
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
