"""The reference arms against each other and, where it is installed, against pinocchio."""

from pathlib import Path

import numpy as np
import pytest

from arms import Planar2R, UrdfArm
from calculator import PLANAR, SEVEN


def states(n, count=5):
    random = np.random.default_rng(3)
    return [(random.uniform(-1.3, 1.3, n), random.standard_normal(n)) for _ in range(count)]


def test_the_closed_form_is_that_of_the_urdf():
    closed = Planar2R()
    chain = UrdfArm(Path(PLANAR["urdf"]), "base", "tip", PLANAR["gravity"])
    for q, v in states(2):
        np.testing.assert_allclose(closed.p(q), chain.p(q)[:2], atol=1e-14)
        np.testing.assert_allclose(closed.J(q), chain.J(q)[:2], atol=1e-14)
        np.testing.assert_allclose(closed.M(q), chain.M(q), atol=1e-14)
        np.testing.assert_allclose(closed.C(q, v), chain.C(q, v), atol=1e-14)
        np.testing.assert_allclose(closed.g(q), chain.g(q), atol=1e-13)


def test_the_urdf_arm_is_that_of_pinocchio():
    reason = "pinocchio (PyPI: pin) is an optional check of the reference"
    pin = pytest.importorskip("pinocchio", reason=reason)
    arm = UrdfArm(Path(SEVEN["urdf"]), SEVEN["base"], SEVEN["tip"], SEVEN["gravity"])
    model = pin.buildModelFromUrdf(SEVEN["urdf"])
    model.gravity.linear = np.array(SEVEN["gravity"])
    data = model.createData()
    frame = model.getFrameId(SEVEN["tip"])
    axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    for q, v in states(arm.n):
        pin.forwardKinematics(model, data, q, v, np.zeros(arm.n))
        pin.updateFramePlacements(model, data)
        np.testing.assert_allclose(arm.p(q), data.oMf[frame].translation, atol=1e-12)
        np.testing.assert_allclose(arm.R(q), data.oMf[frame].rotation, atol=1e-12)
        J = pin.computeFrameJacobian(model, data, q, frame, axes)
        np.testing.assert_allclose(arm.J(q), J, atol=1e-12)
        M = pin.crba(model, data, q)
        M = np.triu(M) + np.triu(M, 1).T
        np.testing.assert_allclose(arm.M(q), M, atol=1e-12)
        np.testing.assert_allclose(
            arm.C(q, v) @ v + arm.g(q), pin.nle(model, data, q, v), atol=1e-11
        )
        np.testing.assert_allclose(
            arm.g(q), pin.computeGeneralizedGravity(model, data, q), atol=1e-11
        )
        acceleration = pin.getFrameClassicalAcceleration(model, data, frame, axes)
        np.testing.assert_allclose(arm.Jdot_v(q, v), acceleration.vector, atol=1e-11)
