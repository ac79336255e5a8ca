"""The model for MuJoCo is the same arm: its own inverse dynamics give the same torques."""

import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

from limber.export import mjcf
from limber.model.robot import load_robot


@pytest.mark.parametrize("name", ["openarm", "planar2r", "panda", "desktop2r", "antagonist2r"])
def test_inverse_dynamics(name):
    """tau = M a + C v + g + n² B a, without friction."""
    mujoco = pytest.importorskip("mujoco")
    arm = load_robot(name)
    model = mujoco.MjModel.from_xml_string(mjcf.text(arm))
    data = mujoco.MjData(model)
    model.dof_damping[:] = 0.0
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    q, v, a = np.random.default_rng(1).uniform(-1.0, 1.0, (3, 10, model.nv))
    rotors = np.array([joint["rotor_inertia_kgm2"] for joint in arm.resolved["joints"]])
    expected = arm.dynamics.torque(q, v, a) + rotors * a
    for k, torque in enumerate(expected):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[k], v[k], a[k]
        mujoco.mj_inverse(model, data)
        np.testing.assert_allclose(data.qfrc_inverse, torque, atol=1e-6 * np.abs(torque).max())
        mujoco.mj_kinematics(model, data)
        np.testing.assert_allclose(data.site_xpos[0], arm.chain.forward(q[k])[:3, 3], atol=1e-6)


def test_numbers_of_robot_yaml():
    arm = load_robot("panda")
    root = ElementTree.fromstring(mjcf.text(arm))
    joints = {joint.get("name"): joint for joint in root.iter("joint")}
    motors = {motor.get("name"): motor for motor in root.iter("motor")}
    first, limits = joints["joint1"], arm.joints[0]
    assert float(first.get("armature")) == pytest.approx(100**2 * 6.05721456e-5, rel=1e-5)
    assert float(first.get("damping")) == 16.0
    assert float(first.get("frictionloss")) == pytest.approx(4.0 + 0.2731)
    assert [float(x) for x in first.get("range").split()] == pytest.approx(
        [limits.low, limits.high]
    )
    assert motors["joint1"].get("forcerange") == "-87 87", "the URDF's effort, the tightest"
    assert root.find("option").get("gravity") == "0 0 -9.81"
    assert any("springs" in what for what in mjcf.left_out(arm))


def test_command_writes_the_file(limber, tmp_path):
    done = limber("export", "mjcf", "planar2r", "--out", str(tmp_path / "arm.xml"))
    assert done.returncode == 0, done.stderr
    ElementTree.parse(tmp_path / "arm.xml")
    missing = limber("export", "mjcf", "planar2r", "--out", str(tmp_path / "no" / "arm.xml"))
    assert missing.returncode == 2 and "cannot be written" in missing.stderr
