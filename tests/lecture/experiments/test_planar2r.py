"""The closed forms that experiments predict from, held against each other and against energy."""

import numpy as np
import pytest

from limber_lecture import planar2r as arm

POSES = [np.array(q) for q in ((0.3, 1.2), (-1.1, 0.4), (2.5, 2.0))]


@pytest.mark.parametrize("q", POSES)
def test_derivatives(q):
    f, v = np.array([3.0, -2.0]), np.array([0.7, -1.3])
    assert arm.derivative(arm.tip, q) == pytest.approx(arm.jacobian(q), abs=1e-12)
    forced = arm.derivative(lambda x: arm.jacobian(x).T @ f, q)
    assert forced == pytest.approx(arm.geometric(q, f), abs=1e-12)
    moved = arm.derivative(lambda x: arm.jacobian(x) @ v, q)
    assert moved == pytest.approx(arm.jacobian_rate(q, v), abs=1e-12)


@pytest.mark.parametrize("q", POSES)
def test_inverse_kinematics(q):
    assert arm.tip(arm.inverse(arm.tip(q))) == pytest.approx(arm.tip(q), abs=1e-12)


@pytest.mark.parametrize("q", POSES)
def test_inertia_is_that_of_many_small_masses(q):
    """Kinetic energy ½ q̇ᵀ M q̇ of rods cut into pieces."""
    v, energy, pieces = np.array([0.7, -1.3]), 0.0, 2000
    for along in (np.arange(pieces) + 0.5) / pieces:
        inner, outer = arm.across(arm.elbow(q)), arm.across(arm.elbow_to_tip(q))
        first = along * inner * v[0]
        second = inner * v[0] + along * outer * (v[0] + v[1])
        energy += (arm.MASSES[0] * first @ first + arm.MASSES[1] * second @ second) / (2 * pieces)
    assert v @ arm.inertia(q) @ v / 2 == pytest.approx(energy, rel=1e-6)


@pytest.mark.parametrize("q", POSES)
def test_weight_is_the_slope_of_the_height(q):
    def potential(x):
        inner, outer = arm.elbow(x) / 2, arm.elbow(x) + arm.elbow_to_tip(x) / 2
        return np.array([9.81 * (arm.MASSES[0] * inner[1] + arm.MASSES[1] * outer[1])])

    assert arm.derivative(potential, q)[0] == pytest.approx(arm.weight(q), abs=1e-12)


@pytest.mark.parametrize("q", POSES)
def test_coriolis_torque_follows_from_the_kinetic_energy(q):
    """Lagrange: Ṁ v - ∂(½ vᵀM v)/∂q."""
    v = np.array([0.7, -1.3])
    rate = arm.derivative(lambda x: arm.inertia(x) @ v, q) @ v
    slope = arm.derivative(lambda x: np.array([v @ arm.inertia(x) @ v / 2]), q)[0]
    assert arm.coriolis(q, v) == pytest.approx(rate - slope, abs=1e-12)
