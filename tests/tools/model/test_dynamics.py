"""Inverse dynamics from a URDF against the controller's own terms, energy and closed forms."""

from pathlib import Path

import numpy as np
import pytest

from limber.model.dynamics import ArmDynamics
from limber.model.robot import load_robot, load_urdf
from limber_lecture.evaluate import case, evaluate


def dynamics_of(name: str) -> ArmDynamics:
    return load_robot(name).dynamics


def dynamics_in(path: Path, text: str, base: str, tip: str, g: float) -> ArmDynamics:
    path.write_text(text)
    robot = load_urdf(path, base, tip)
    return ArmDynamics(robot.chain, robot.bodies, np.array([0.0, 0.0, -g]))


@pytest.mark.parametrize(
    "name",
    ["openarm", "planar2r", "ideal7", "desktop2r", "iiwa14", "panda", "baxter", "antagonist7"],
)
def test_same_arm_as_the_controllers(name):
    """KDL's chain, read by other code: M from unit accelerations, C v and g."""
    arm = dynamics_of(name)
    n, rng = arm.size, np.random.default_rng(1)
    q, v = rng.uniform(-1.0, 1.0, n), rng.uniform(-1.0, 1.0, n)
    told = evaluate([case("kin_dyn", name, q=q, v=v)])[0]
    rest = np.zeros((n, n))
    poses = np.tile(q, (n, 1))
    g = arm.gravity_torque(q[None])[0]
    np.testing.assert_allclose(g, told["g"], atol=1e-9)
    np.testing.assert_allclose(
        arm.torque(poses, rest, np.eye(n)) - g, np.array(told["M"]).reshape(n, n), atol=1e-9
    )
    Cv = arm.torque(q[None], v[None], np.zeros((1, n)))[0] - g
    np.testing.assert_allclose(Cv, told["Cv"], atol=1e-9)


@pytest.mark.parametrize("name", ["openarm", "desktop2r", "antagonist7"])
def test_torque_is_linear_in_masses_moments_and_inertias(name):
    arm = dynamics_of(name)
    q, v, a = np.random.default_rng(2).uniform(-1.5, 1.5, (3, 6, arm.size))
    np.testing.assert_allclose(
        arm.regressor(q, v, a) @ arm.parameters(), arm.torque(q, v, a), atol=1e-10
    )
    by_weight = arm.parameters().reshape(-1, 10)[:, :4].ravel()
    np.testing.assert_allclose(
        arm.gravity_regressor(q) @ by_weight, arm.gravity_torque(q), atol=1e-12
    )


URDF = """<robot name="r">
  <link name="base"><inertial><mass value="50"/></inertial></link>
  <link name="carriage"><inertial><mass value="2"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <link name="arm"><inertial><origin xyz="0.3 0 0"/><mass value="1"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.02"/></inertial></link>
  <link name="tool"><inertial><origin xyz="0.1 0 0"/><mass value="0.5"/>
    <inertia ixx="0.001" ixy="0" ixz="0" iyy="0.001" iyz="0" izz="0.001"/></inertial></link>
  <joint name="slide" type="prismatic"><parent link="base"/><child link="carriage"/>
    <axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1" effort="1"/></joint>
  <joint name="turn" type="continuous"><parent link="carriage"/><child link="arm"/>
    <axis xyz="0 1 0"/></joint>
  <joint name="grip" type="revolute"><parent link="arm"/><child link="tool"/>
    <origin xyz="0.6 0 0"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="1" velocity="1" effort="1"/></joint>
</robot>"""


def test_sliding_joint_and_a_branch_by_hand(tmp_path):
    """A carriage that slides upwards with a pendulum on it; the tool hangs on as load."""
    arm = dynamics_in(tmp_path / "r.urdf", URDF, "base", "arm", 10.0)
    mass, moment = 1.5, 0.3 + 0.5 * 0.7
    inertia = 0.02 + 0.3**2 + 0.001 + 0.5 * 0.7**2  # about the turning axis
    assert arm.bodies[1].heaviest == "arm"
    q, v, a = np.array([[0.2, 0.4]]), np.array([[0.7, -1.3]]), np.array([[2.0, 3.0]])
    s, c = np.sin(0.4), np.cos(0.4)  # turning about +y lowers the arm: z = -x sin q
    slide = (2.0 + mass) * (2.0 + 10.0) - moment * (c * 3.0 - s * 1.3**2)
    turn = inertia * 3.0 - moment * c * (2.0 + 10.0)
    np.testing.assert_allclose(arm.torque(q, v, a)[0], [slide, turn], rtol=1e-12)


TELESCOPE = """<robot name="r">
  <link name="base"/>
  <link name="boom"><inertial><mass value="3"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="0.5"/></inertial></link>
  <link name="rod"><inertial><mass value="2"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="0.25"/></inertial></link>
  <joint name="turn" type="continuous"><parent link="base"/><child link="boom"/>
    <axis xyz="0 0 1"/></joint>
  <joint name="reach" type="prismatic"><parent link="boom"/><child link="rod"/>
    <origin xyz="0.5 0 0"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="1" velocity="1" effort="1"/></joint>
</robot>"""


def test_turning_telescope_by_hand(tmp_path):
    """Polar coordinates: m (r'' - r w²) along the rod, (I + m r²) w' + 2 m r r' w about z."""
    arm = dynamics_in(tmp_path / "r.urdf", TELESCOPE, "base", "rod", 9.81)
    r, w, rate = 0.8, 1.5, -0.6
    tau = arm.torque(np.array([[2.0, 0.3]]), np.array([[w, rate]]), np.array([[0.7, 0.9]]))[0]
    turn = (0.75 + 2.0 * r**2) * 0.7 + 2.0 * 2.0 * r * rate * w
    np.testing.assert_allclose(tau, [turn, 2.0 * (0.9 - r * w**2)], rtol=1e-12)


QUIRKS = """<robot name="quirks" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <link name="base"><inertial><mass value="0"/><inertia ixx="1" iyy="1,5" izz="-1"/></inertial>
  </link>
  <link name="head"><inertial><mass value="heavy"/></inertial></link>
  <joint name="neck" type="hinge"><parent link="base"/><child link="head"/>
    <origin xyz="nan 0 0"/><axis xyz="0 0 0"/><limit lower="low"/></joint>
  <link name="flange"/>
  <joint name="bolt" type="fixed"><parent link="base"/><child link="flange"/>
    <origin xyz="0 0 0.3" rpy="0.1 0.2 0"/><axis xyz="0 0 0"/><limit lower="x"/></joint>
  <link name="upper"/>
  <joint name="pan" type="revolute"><parent link="flange"/><child link="upper"/>
    <axis xyz="0 0 2"/><limit lower="0" upper="0" effort="0" velocity="0"/></joint>
  <link name="fore"><inertial><origin xyz="0.2 0 0.01"/><mass value="1500"/>
    <inertia ixx="-0.5" ixy="0" ixz="0" iyy="30" iyz="0" izz="60"/></inertial></link>
  <joint name="tilt" type="revolute"><parent link="upper"/><child link="fore"/>
    <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="9" velocity="1"/></joint>
  <link name="rotor"><inertial><mass value="0"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.2"/></inertial></link>
  <joint name="spin" type="continuous"><parent link="fore"/><child link="rotor"/>
    <origin xyz="0.5 0 0" rpy="0 0 0.4"/><axis xyz="0 0 0"/></joint>
  <link name="tip"><inertial><mass value="3"/>
    <inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial></link>
  <joint name="mount" type="fixed"><parent link="fore"/><child link="tip"/>
    <origin xyz="0.9 0 0"/><axis xyz="0 0 0"/></joint>
</robot>"""


def test_quirks_of_vendors_are_read_as_the_controller_reads_them(tmp_path):
    """Slips where they do not count, and inertias that no body has."""
    path = tmp_path / "quirks.urdf"
    path.write_text(QUIRKS)
    robot = load_urdf(path, "base", "tip")
    assert (robot.joints[0].low, robot.joints[0].high) == (-np.inf, np.inf)
    chain, arm = robot.chain, robot.dynamics
    q, rest = np.array([0.3, -0.7]), np.zeros((2, 2))
    file = {"urdf": str(path), "base": "base", "tip": "tip"}
    told = evaluate([case("kin_dyn", file, q=q, v=np.zeros(2))])[0]
    g = arm.gravity_torque(q[None])[0]
    np.testing.assert_allclose(g, told["g"], rtol=1e-9)
    M = arm.torque(np.tile(q, (2, 1)), rest, np.eye(2)) - g
    np.testing.assert_allclose(M, np.array(told["M"]).reshape(2, 2), rtol=1e-9)
    np.testing.assert_allclose(chain.forward(q)[:3, 3], told["p"], rtol=1e-9)


def test_a_joint_without_a_mass_of_its_own(tmp_path):
    arm = dynamics_in(tmp_path / "quirks.urdf", QUIRKS, "base", "tip", 9.81)
    assert [body.mass for body in arm.bodies] == [0.0, 1503.0]
