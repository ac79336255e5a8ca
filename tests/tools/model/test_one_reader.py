"""URDFs as exporters write them: check, new and Python come to one verdict, and to one arm."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from limber.errors import InputError
from limber.model.checker import resolved, run_checker
from limber.model.robot import load_robot, load_urdf
from limber.model.xml_file import read_xml
from limber.monitor.shapes import figure

ARM = """<robot name="six"{root}>
  <link name="base"/>{extra}
  <joint name="rot_z" type="revolute"><parent link="base"/><child link="one"/>
    <origin xyz="0.02 0 0.1" {turn}/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="20" velocity="3"{limit}/></joint>
  <link name="one"><inertial><origin xyz="0 0.01 0.1" {turn}/><mass value="2"/>
    <inertia ixx="0.03" ixy="0.001" ixz="0" iyy="0.02" iyz="0" izz="0.01"/></inertial></link>
  <joint name="lift" type="revolute"><parent link="one"/><child link="two"/>
    <origin xyz="0 0 0.3" {turn}/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="20" velocity="3"{limit}/></joint>
  <link name="two"><inertial><origin xyz="0.1 0 0"/><mass value="1"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.005"/></inertial>
    <visual><origin xyz="0.1 0 0" {turn}/><geometry><capsule radius="0.02" length="0.2"/></geometry>
    </visual></link>
</robot>
"""
PLAIN = {"root": "", "extra": "", "turn": 'rpy="0.3 -0.4 1.1"', "limit": ""}
ROLL_PITCH_YAW = (0.3, -0.4, 1.1)
AS_A = ["--name", "a", "--drives", "damiao"]
QUATERNION = " ".join(f"{x:.17g}" for x in Rotation.from_euler("xyz", ROLL_PITCH_YAW).as_quat())


def written(folder, **changes) -> str:
    path = folder / "arm.urdf"
    path.write_bytes(ARM.format(**PLAIN | changes).encode())
    return path


READ = {
    "plain": {},
    "version 1.1": {"root": ' version="1.1"'},
    "quaternions": {"root": ' version="1.2"', "turn": f'quat_xyzw="{QUATERNION}"'},
    "acceleration limits": {"limit": ' acceleration="9" deceleration="9" jerk="99"'},
    "foreign attribute": {"root": ' xmlns:drake="http://d"', "limit": ' drake:acceleration="9"'},
    "prefix nobody declares": {"extra": '<gazebo><controller:x name="cm"/></gazebo>'},
    "foreign element in a link": {
        "extra": '<link name="l2"><acme:inertial/></link>'
        '<joint name="f" type="fixed"><parent link="base"/>'
        '<child link="l2"/></joint>'
    },
    "ascii in gb2312": {"head": "gb2312"},
    "umlauts": {"extra": "<!-- Größe: 1 µm -->"},
}


@pytest.mark.parametrize("kind", READ)
def test_one_arm_for_all_readers(kind, limber, tmp_path):
    changes = dict(READ[kind])
    head = changes.pop("head", None)
    path = written(tmp_path, **changes)
    if head:
        text = f'<?xml version="1.0" encoding="{head}"?>\n' + path.read_text()
        path.write_text(text)
    ends = ["--base", "base", "--tip", "two"]
    found, robot = resolved(["urdf", str(path), *ends, "--json"]), load_urdf(path, "base", "two")
    X = robot.chain.forward(np.zeros(2))
    np.testing.assert_allclose(X[:3, 3], found["home_p_BT"], atol=1e-9)
    R = Rotation.from_euler("xyz", ROLL_PITCH_YAW)
    expected = np.array([0.02, 0, 0.1]) + R.apply([0, 0, 0.3])
    np.testing.assert_allclose(X[:3, 3], expected, atol=1e-9)
    np.testing.assert_allclose(X[:3, :3], (R * R).as_matrix(), atol=1e-9)
    tensor = np.array([[0.03, 0.001, 0], [0.001, 0.02, 0], [0, 0, 0.01]])
    turned = R.as_matrix() @ tensor @ R.as_matrix().T
    np.testing.assert_allclose(robot.inertials["one"].inertia, turned, atol=1e-12)
    made = limber("new", str(path), "--base", "base", "--tip", "two", *AS_A, cwd=tmp_path)
    assert made.returncode == 0, made.stderr


REFUSED = {
    "dashes in a comment": b"<!-- a--b -->",
    "an attribute twice": b"<x a='1' a='2'/>",
    "a less-than sign": b"<x a='1 < 2'/>",
    "no UTF-8": "<!-- Größe -->".encode("latin-1"),
    "a control character": b"<x a='\x01'/>",
}


@pytest.mark.parametrize("kind", REFUSED)
def test_one_refusal_for_all_readers(kind, limber, tmp_path):
    path = written(tmp_path, extra="@@")
    data = path.read_bytes().replace(b"@@", REFUSED[kind])
    path.write_bytes(data)
    line = 1 + data[: data.index(REFUSED[kind])].count(b"\n")
    done = run_checker(["urdf", str(path), "--base", "base", "--tip", "two"])
    assert done.returncode == 2 and f"arm.urdf:{line}: not well-formed XML" in done.stderr
    made = limber("new", str(path), "--base", "base", "--tip", "two", *AS_A, cwd=tmp_path)
    assert made.returncode == 2 and f"arm.urdf:{line}: not well-formed XML" in made.stderr
    with pytest.raises(InputError, match=f"arm.urdf:{line}: .*not well-formed XML"):
        read_xml(path)


def test_a_capsule_is_drawn_as_long_as_it_is(limber, tmp_path):
    """0.2 m between its half balls of 0.02 m, turned as its origin says."""
    path = written(tmp_path)
    made = limber("new", str(path), "--base", "base", "--tip", "two", *AS_A, cwd=tmp_path)
    assert made.returncode == 0, made.stderr
    drawn = figure(load_robot(str(tmp_path / "a")))
    assert drawn.troubles == []
    (shape,) = [
        shape for shape in drawn.shapes if shape.link == "two" and len(shape.mesh.vertices) > 100
    ][:1]
    axis = Rotation.from_euler("xyz", ROLL_PITCH_YAW).apply([0, 0, 1])
    along = (shape.mesh.vertices - [0.1, 0, 0]) @ axis
    assert along.max() == pytest.approx(0.12, abs=1e-3) and along.min() == pytest.approx(
        -0.12, abs=1e-3
    )
    away = np.linalg.norm(shape.mesh.vertices - [0.1, 0, 0] - np.outer(along, axis), axis=1)
    assert away.max() == pytest.approx(0.02, abs=1e-3)


def test_a_proposal_keeps_prefixes_and_quaternions(tmp_path):
    from limber.identify.urdf_edit import with_inertials

    path = written(tmp_path, **READ["quaternions"], limit=' drake:acceleration="9"')
    text = with_inertials(path, {"one": (2.5, np.array([0, 0, 0.2]))})
    assert text.count('drake:acceleration="9"') == 2 and text.count("quat_xyzw") == 4
    (tmp_path / "new.urdf").write_text(text)
    assert load_urdf(tmp_path / "new.urdf", "base", "two").inertials["one"].mass == 2.5
