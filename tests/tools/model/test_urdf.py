"""Kinematics from a URDF against closed forms and against differences."""

import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from limber.errors import InputError
from limber.model.robot import load_robot, load_urdf

A1, A2 = 0.35, 0.3  # m, links of desktop2r
POSES = [(0.0, 0.0), (0.4, -1.1), (-2.0, 2.3), (1.2, 0.7)]


@pytest.fixture(scope="module")
def planar():
    return load_robot("desktop2r").chain


@pytest.mark.parametrize("q", POSES)
def test_desktop2r_closed_form(planar, q):
    q1, q2 = q
    s1, c1, s12, c12 = np.sin(q1), np.cos(q1), np.sin(q1 + q2), np.cos(q1 + q2)
    X_BT = planar.forward(np.array(q))
    np.testing.assert_allclose(X_BT[:3, 3], [A1 * c1 + A2 * c12, A1 * s1 + A2 * s12, 0], atol=1e-12)
    np.testing.assert_allclose(X_BT[:2, :2], [[c12, -s12], [s12, c12]], atol=1e-12)
    J = [[-A1 * s1 - A2 * s12, -A2 * s12], [A1 * c1 + A2 * c12, A2 * c12]]
    np.testing.assert_allclose(planar.jacobian(np.array(q))[:2], J, atol=1e-12)
    np.testing.assert_allclose(
        planar.jacobian(np.array(q))[2:], [[0, 0]] * 3 + [[1, 1]], atol=1e-12
    )


def test_jacobian_is_the_derivative_of_the_pose():
    chain = load_robot("openarm").chain
    q = np.random.default_rng(5).uniform(-0.5, 0.5, 7) + 0.5
    J, step = chain.jacobian(q), 1e-6
    for i in range(7):
        ahead, behind = (chain.forward(q + s * step * np.eye(7)[i]) for s in (1, -1))
        v = (ahead[:3, 3] - behind[:3, 3]) / (2 * step)
        turned = Rotation.from_matrix(ahead[:3, :3] @ behind[:3, :3].T).as_rotvec()
        np.testing.assert_allclose(J[:, i], [*v, *(turned / (2 * step))], atol=1e-8)


URDF = """<robot name="r">
  <link name="base"/><link name="a"/><link name="b"/><link name="c"><inertial><mass value="1"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link><link name="side"/>
  <joint name="lift" type="prismatic">
    <parent link="base"/><child link="a"/><origin xyz="0 0 1" rpy="0 0 1.5707963267948966"/>
    <axis xyz="2 0 0"/><limit lower="-1" upper="1" velocity="1" effort="1"/>
  </joint>
  <joint name="glue" type="fixed">
    <parent link="a"/><child link="b"/><origin rpy="0.3 0.2 0.1"/>
  </joint>
  <joint name="turn" type="continuous">
    <parent link="b"/><child link="c"/><origin xyz="0 0.5 0"/><axis xyz="0 0 1"/>
  </joint>
  <joint name="aside" type="revolute">
    <parent link="a"/><child link="side"/><limit lower="0" upper="1" velocity="1" effort="1"/>
  </joint>
</robot>"""


@pytest.fixture
def urdf(tmp_path):
    path = tmp_path / "r.urdf"
    path.write_text(URDF)
    return path


def test_prismatic_fixed_continuous_and_branches(urdf):
    robot = load_urdf(urdf, "base", "c")
    chain, (lift, turn) = robot.chain, robot.joints
    assert chain.joint_names == ["lift", "turn"]
    assert (lift.low, lift.high, lift.velocity, lift.torque) == (-1.0, 1.0, 1.0, 1.0)
    assert (turn.low, turn.high, turn.velocity, turn.torque) == (-np.inf, *[np.inf] * 3)
    X = chain.forward(np.array([0.25, 0.0]))
    # rpy turns about fixed axes: first roll about x, then pitch about y, then yaw about z
    roll, pitch, yaw = (Rotation.from_rotvec(v) for v in ([0.3, 0, 0], [0, 0.2, 0], [0, 0, 0.1]))
    quarter = Rotation.from_rotvec([0, 0, np.pi / 2])
    R = quarter * yaw * pitch * roll
    np.testing.assert_allclose(X[:3, :3], R.as_matrix(), atol=1e-12)
    # the lift slides along the parent's y, a quarter turn away; its axis counts as a direction
    np.testing.assert_allclose(X[:3, 3] - R.apply([0, 0.5, 0]), [0, 0.25, 1], atol=1e-12)
    np.testing.assert_allclose(chain.jacobian(np.zeros(2))[:, 0], [0, 1, 0, 0, 0, 0], atol=1e-12)


def test_no_way_between_links(urdf):
    with pytest.raises(InputError, match="tip: link 'side' does not lie below the base 'c'"):
        load_urdf(urdf, "c", "side")


def test_broken_file(tmp_path):
    path = tmp_path / "broken.urdf"
    path.write_text("<robot><link")
    with pytest.raises(InputError, match=r"broken.urdf:1: not well-formed XML"):
        load_urdf(path, "a", "b")


@pytest.mark.parametrize(
    ("whole", "cut", "complaint"),
    [
        ('<parent link="b"/>', "", "joint 'turn': <parent link=\"...\"/> is missing"),
        ('<child link="c"/>', "<child/>", "joint 'turn': <child link=\"...\"/> is missing"),
        ('<joint name="turn" type="continuous">', '<joint name="turn">', "joint 'turn': type ''"),
    ],
)
def test_what_a_joint_lacks_is_named(tmp_path, whole, cut, complaint):
    assert URDF.count(whole) == 1
    path = tmp_path / "r.urdf"
    path.write_text(URDF.replace(whole, cut))
    with pytest.raises(InputError, match=re.escape(f"{path}:11: {complaint}")):
        load_urdf(path, "base", "c")
