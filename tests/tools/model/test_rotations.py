"""Rotations against SciPy's, which is written by others."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from limber.model import rotations

RANDOM = Rotation.random(50, random_state=1)
HALF_TURNS = Rotation.from_rotvec(
    np.pi * np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [0.6, 0, 0.8]])
)
NEAR_ZERO = Rotation.from_rotvec([[0, 0, 0], [1e-9, 0, 0], [0, -1e-5, 1e-6]])
ALL = Rotation.concatenate([RANDOM, HALF_TURNS, NEAR_ZERO])


def quats(turns: Rotation) -> np.ndarray:
    return turns.as_quat(scalar_first=True)


def test_matrix_of_a_quaternion_of_any_length():
    np.testing.assert_allclose(rotations.matrix_of(3 * quats(ALL)), ALL.as_matrix(), atol=1e-14)
    np.testing.assert_allclose(rotations.matrix_of(quats(ALL)[0]), ALL[0].as_matrix(), atol=1e-14)


def test_quaternion_of_a_matrix():
    found = rotations.quaternion_of(ALL.as_matrix())
    assert (found[:, 0] >= 0).all()
    same = np.abs(np.sum(found * quats(ALL), axis=1))
    np.testing.assert_allclose(same, 1, atol=1e-14)
    back = rotations.matrix_of(rotations.quaternion_of(ALL[3].as_matrix()))
    np.testing.assert_allclose(back, ALL[3].as_matrix(), atol=1e-14)


def test_product_and_what_is_between():
    a, b = RANDOM[:25], RANDOM[25:]
    product = rotations.matrix_of(rotations.product(quats(a), quats(b)))
    np.testing.assert_allclose(product, (a * b).as_matrix(), atol=1e-14)
    turned = rotations.between(quats(a), -quats(b))  # of either sign
    np.testing.assert_allclose(turned, (b * a.inv()).as_rotvec(), atol=1e-13)
    small = rotations.between(quats(NEAR_ZERO), quats(NEAR_ZERO * NEAR_ZERO))
    np.testing.assert_allclose(small, NEAR_ZERO.as_rotvec(), atol=1e-15)


def test_matrix_of_a_vector():
    vectors = np.concatenate([ALL.as_rotvec(), [[0, 4.0, 3.0]]])  # more than a half turn, too
    expected = Rotation.from_rotvec(vectors).as_matrix()
    np.testing.assert_allclose(rotations.turned_about(vectors), expected, atol=1e-14)


def test_mean_of_some_that_are_near():
    some = Rotation.from_rotvec(0.3 * np.random.default_rng(1).normal(size=(20, 3))) * RANDOM[7]
    signs = np.where(np.arange(20) % 2, 1.0, -1.0)[:, None]
    found = rotations.matrix_of(rotations.mean(signs * quats(some)))
    np.testing.assert_allclose(found, some.mean().as_matrix(), atol=1e-13)


@pytest.mark.parametrize("direction", [[0, 0, 1], [0, 0, -1], [0.6, 0, 0.8], [0, -1, 0]])
def test_from_z(direction):
    R = rotations.matrix_of(rotations.from_z(np.array(direction, float)))
    np.testing.assert_allclose(R[:, 2], direction, atol=1e-14)
    angle = np.linalg.norm(Rotation.from_matrix(R).as_rotvec())
    assert angle == pytest.approx(np.arccos(direction[2]), abs=1e-12), "the shortest"
