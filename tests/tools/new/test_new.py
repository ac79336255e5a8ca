"""`limber new`: what it writes loads without an edit, and the first scenario ends well."""

import json

import pytest
import yaml

from limber.paths import ROOT

ARM = ROOT / "tests" / "robots" / "data" / "arm" / "robot.urdf"  # one joint slides
OPENARM = ROOT / "robots" / "openarm" / "robot.urdf"
ENDS = ["--base", "world", "--tip", "link8"]

# as exporters write it: no limits at all, names that YAML would read as something else
BARE = """<robot name="bare"><link name="base"/>
  <link name="on"><inertial><origin xyz="0 0 0.2"/><mass value="4"/>
    <inertia ixx="0.06" ixy="0" ixz="0" iyy="0.06" iyz="0" izz="0.01"/></inertial></link>
  <joint name="1" type="revolute"><parent link="base"/><child link="on"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="0" effort="0" velocity="0"/></joint>
  <link name="hand"><inertial><origin xyz="0.1 0 0.1"/><mass value="1"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
  <joint name="wrist: turn" type="continuous"><parent link="on"/><child link="hand"/>
    <origin xyz="0 0 0.4"/><axis xyz="0 0 1"/></joint>
</robot>"""

SECOND = """<link name="left"/>
  <joint name="shoulder" type="continuous"><parent link="base"/><child link="left"/></joint>
"""


def made(limber, folder, urdf, *arguments):
    done = limber("new", str(urdf), "--name", "mine", *arguments, cwd=folder)
    assert done.returncode == 0, done.stderr
    return done.stdout


def check_and_lab(limber, folder):
    """Both end well, and the push was measured."""
    checked = limber("check", "mine", cwd=folder)
    assert checked.returncode == 0, checked.stderr
    run = limber("lab", "mine_first.yaml", "--out", "run", cwd=folder)
    assert run.returncode == 0, run.stdout + run.stderr
    summary = json.loads((folder / "run" / "summary.json").read_text())
    push = [result for result in summary["results"] if result["name"].startswith("stiffness")]
    assert len(push) == 1 and push[0]["pass"]
    return run.stdout


LINK = """<link name="{0}"><inertial><origin xyz="{1}"/><mass value="{2}"/>
  <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>"""
JOINT = """<joint name="{0}" type="{1}"><parent link="{2}"/><child link="{3}"/>
  <origin xyz="{4}"/><axis xyz="{5}"/><limit {6} effort="{7}" velocity="2"/></joint>"""
SHORT_TRAVELS = {
    "a SCARA's quill": [
        ("a1", "revolute", "0 0 0.3", "0 0 1", 'lower="-2.2" upper="2.2"', 40, "0.15 0 0", 3),
        ("a2", "revolute", "0.3 0 0", "0 0 1", 'lower="-2.5" upper="2.5"', 25, "0.12 0 0", 2),
        ("z", "prismatic", "0.25 0 0", "0 0 1", 'lower="-0.18" upper="0"', 100, "0 0 -0.05", 0.8),
    ],
    "a short quill": [
        ("a1", "revolute", "0 0 0.3", "0 0 1", 'lower="-2" upper="2"', 40, "0.15 0 0", 3),
        ("z", "prismatic", "0.3 0 0", "0 0 1", 'lower="0" upper="0.05"', 100, "0 0 -0.05", 0.8),
    ],
    "a short elbow": [
        ("s", "revolute", "0 0 0.3", "0 1 0", 'lower="-1" upper="1"', 60, "0 0 0.15", 2),
        ("e", "revolute", "0 0 0.3", "0 1 0", 'lower="0" upper="0.6"', 30, "0.1 0 0.1", 1),
    ],
    "a torso": [
        ("lift", "prismatic", "0 0 0.3", "0 0 1", 'lower="0" upper="0.4"', 900, "0 0 0.2", 12),
        ("turn", "revolute", "0 0 0.2", "0 0 1", 'lower="-1" upper="0"', 60, "0.2 0 0", 3),
    ],
}


def urdf_of(joints) -> str:
    text, below = '<link name="base"/>', "base"
    for name, kind, at, axis, ends, effort, com, mass in joints:
        text += LINK.format(f"of_{name}", com, mass)
        text += JOINT.format(name, kind, below, f"of_{name}", at, axis, ends, effort)
        below = f"of_{name}"
    return f'<robot name="r">{text}</robot>'


@pytest.mark.parametrize("kind", SHORT_TRAVELS)
def test_the_first_scenario_never_starts_in_a_soft_wall(limber, tmp_path, kind):
    (tmp_path / "arm.urdf").write_text(urdf_of(SHORT_TRAVELS[kind]))
    made(limber, tmp_path, tmp_path / "arm.urdf", "--drives", "damiao")
    assert "soft wall" not in limber("check", "mine_first.yaml", cwd=tmp_path).stdout
    check_and_lab(limber, tmp_path)


@pytest.mark.parametrize(
    "drives", ["damiao", "moteus", "cia402", "robstride", "myactuator", "cubemars", "odrive"]
)
def test_a_published_arm_with_each_kind_of_drives(limber, tmp_path, drives):
    told = made(limber, tmp_path, OPENARM, *ENDS, "--drives", drives)
    assert len(told.splitlines()) == 4  # what was made, and three steps
    text = (tmp_path / "mine" / "robot.yaml").read_text()
    robot = yaml.safe_load(text)
    assert {motor["protocol"] for motor in robot["motors"].values()} == {
        {"damiao": "damiao_mit"}.get(drives, drives)
    }
    assert all(bus["can"].startswith("virtual:") for bus in robot["buses"])
    for bus in robot["buses"]:
        numbers = [joint["id"] for joint in robot["joints"].values() if joint["bus"] == bus["name"]]
        assert numbers == list(range(1, len(numbers) + 1))
    assert f"{text.count('guess:')} guesses" in told
    assert (tmp_path / "mine" / "robot.urdf").read_bytes() == OPENARM.read_bytes()
    check_and_lab(limber, tmp_path)


def test_an_arm_that_slides(limber, tmp_path):
    made(limber, tmp_path, ARM, "--base", "base", "--tip", "hand", "--drives", "damiao")
    told = check_and_lab(limber, tmp_path)
    # its finger, once as load and once as a joint
    assert f"2 notes on {tmp_path / 'mine'}: limber check mine_first.yaml lists them" in told
    refused = limber(
        *["new", str(ARM), "--base", "base", "--tip", "hand", "--drives", "moteus"], cwd=tmp_path
    )
    assert refused.returncode == 2
    assert "slide slides: use damiao" in refused.stderr


def test_placeholders_become_guesses(limber, tmp_path):
    urdf = tmp_path / "bare.urdf"
    urdf.write_text(BARE)
    made(limber, tmp_path, urdf, "--drives", "moteus")  # one arm: no ends needed
    joints = yaml.safe_load((tmp_path / "mine" / "robot.yaml").read_text())["joints"]
    assert list(joints) == ["1", "wrist: turn"]
    assert all(joint["urdf_limits"] == "ignore" for joint in joints.values())
    assert joints["1"]["torque_limit_Nm"] > 2 * 9.81  # more than its weight at a lever of 0.4 m
    check_and_lab(limber, tmp_path)


def test_a_heavy_arm_is_held(limber, tmp_path):
    """Its weight comes within the torque's rate limit, and so does the torque of the hold."""
    urdf = tmp_path / "heavy.urdf"
    sideways = BARE.replace('xyz="0 0 0.2"', 'xyz="0.4 0 0.2"')
    urdf.write_text(sideways.replace('value="4"', 'value="400"'))
    made(limber, tmp_path, urdf, "--drives", "cia402")
    joint = yaml.safe_load((tmp_path / "mine" / "robot.yaml").read_text())["joints"]["1"]
    assert joint["torque_rate_limit_Nm_per_s"] > 1000
    check_and_lab(limber, tmp_path)


def test_nothing_is_overwritten(limber, tmp_path):
    words = [str(OPENARM), *ENDS, "--drives", "damiao", "--name", "mine"]
    (tmp_path / "mine_first.yaml").write_text("mine")
    refused = limber("new", *words, cwd=tmp_path)
    assert refused.returncode == 2 and "mine_first.yaml exists already" in refused.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["mine_first.yaml"]
    (tmp_path / "mine_first.yaml").unlink()
    (tmp_path / "mine").mkdir()
    refused = limber("new", *words, cwd=tmp_path)
    assert refused.returncode == 2 and "exists already" in refused.stderr
    assert not list((tmp_path / "mine").iterdir())


def test_several_arms_are_listed(limber, tmp_path):
    two = BARE.replace("</robot>", SECOND + "</robot>")
    (tmp_path / "arm.urdf").write_text(two)
    for command in (["new", "arm.urdf", "--drives", "damiao"], ["check", "arm.urdf"]):
        refused = limber(*command, cwd=tmp_path)
        assert refused.returncode == 2
        listed = refused.stdout + refused.stderr
        assert "which arm? give --base LINK and --tip LINK" in listed
        assert "--base base --tip hand" in listed
        assert "--base base --tip left" in listed
    assert [path.name for path in tmp_path.iterdir()] == ["arm.urdf"]
