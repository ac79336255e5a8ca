"""What limber-check resolves robots and scenarios to, as Python has it, and what is kept of it."""

import json
import shutil

import numpy as np
import pytest

from limber.errors import InputError
from limber.model import robot as robots
from limber.model.robot import keep_description, load_robot, load_urdf, robot_beside
from limber.model.scenario import keep_scenario, load_scenario, scenario_beside
from limber.paths import robot_folder, robot_names

TIMELINE = """duration_s: 9
timeline:
  - {at_s: 5, gains: {K_x_rotation_Nm_per_rad: 7}}
  - {at_s: 1, gains: {law: joint_pd, friction_compensation: dither, K_x: [
      [100, 0, 0, 0, 20, 0], [0, 100, 0, 0, 0, 0], [0, 0, 100, 0, 0, 0],
      [0, 0, 0, 9, 0, 0], [20, 0, 0, 0, 9, 0], [0, 0, 0, 0, 0, 9]]}}
  - {at_s: 2, gains: {K_q_Nm_per_rad: 11, frame: goal}}
  - {at_s: 3, gains: {K_x_translation_N_per_m: [1, 2, 3]}}
  - {at_s: 4, gains: {reset: true, friction_share: 0.5}}
  - {at_s: 6, push: {force_N: [0, 3, 0], for_s: 1, ramp_s: 0.25}}
  - {at_s: 7, wall: {point_m: [0.1, 0, 0], normal: [0.6, 0, 0.8], stiffness_N_per_m: 900}}
  - {at_s: 7.5, wall: "off"}
  - {at_s: 8, fault: {joint: elbow, kind: hot}}
"""


@pytest.fixture
def copied(tmp_path):
    """A user's own folder."""
    folder = tmp_path / "mine"
    shutil.copytree(robot_folder("desktop2r"), folder)
    return folder


def changed(folder, old: str, new: str) -> None:
    file = folder / "robot.yaml"
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new, 1))


def test_gains_as_they_hold(scenario):
    """What is not named stays; a block clears its coupling; a reset keeps the law alone."""
    own, first, second, third, reset, last = scenario("desktop2r", TIMELINE).gains
    coupled = np.diag([100.0] * 3 + [9.0] * 3)
    coupled[0, 4] = coupled[4, 0] = 20.0
    assert own.at_s == 0 and own.law == "cartesian_impedance" and own.frame == "base"
    np.testing.assert_array_equal(first.K_x, coupled)
    np.testing.assert_array_equal(first.K_q, own.K_q)
    assert first.dithered and second.dithered and second.law == "joint_pd"
    np.testing.assert_array_equal(second.K_x, coupled)
    np.testing.assert_array_equal(second.K_q, [11.0, 11.0])
    np.testing.assert_array_equal(third.K_x, np.diag([1.0, 2.0, 3.0, 9.0, 9.0, 9.0]))
    assert (third.frame, third.friction_compensation) == ("goal", "dither")
    np.testing.assert_array_equal(reset.K_x, own.K_x)
    assert (reset.law, reset.frame, reset.friction_compensation) == ("joint_pd", "base", "none")
    assert (reset.friction_share, last.friction_share) == (0.5, 0.5)
    np.testing.assert_array_equal(np.diag(last.K_x)[3:], [7.0] * 3)
    np.testing.assert_array_equal(last.K_x[:3, :3], own.K_x[:3, :3])


def test_the_rest_of_a_timeline(scenario):
    found = scenario("desktop2r", TIMELINE)
    (push,), (wall,) = found.pushes, found.walls
    np.testing.assert_array_equal(push.wrench, [0, 3, 0, 0, 0, 0])
    assert (push.at_s, push.ramp_s, push.duration_s, push.link) == (6, 0.25, 1, "")
    np.testing.assert_allclose(wall.normal, [0.6, 0, 0.8])
    assert (wall.at_s, wall.stiffness_N_per_m) == (7, 900)
    assert found.faults == ["hot"]
    assert found.event_times == sorted(found.event_times) and 0.3 in found.event_times
    assert (found.tolerances.stiffness, found.lockstep, found.record) == (0.02, True, True)


@pytest.mark.parametrize("name", robot_names())
def test_each_shipped_robot_moves_within_its_limits(name):
    robot = load_robot(name)
    assert robot.name == name and robot.joint_names == robot.chain.joint_names
    for joint, home in zip(robot.joints, robot.home, strict=True):
        assert joint.low <= home <= joint.high and 0 < joint.torque < np.inf
    assert np.linalg.norm(robot.gravity) == pytest.approx(9.81) or not robot.gravity.any()
    assert set(robot.resolved["gains"]["K_null_Nm_per_rad"]) and robot.buses


def test_what_is_unlimited_is_infinite(tmp_path):
    path = tmp_path / "a.urdf"
    path.write_text(
        '<robot name="a"><link name="base"/><link name="arm"><inertial><mass value="1"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        '<joint name="j" type="continuous"><parent link="base"/><child link="arm"/>'
        '<axis xyz="0 0 3"/></joint></robot>'
    )
    robot = load_urdf(path, "base", "arm")
    (joint,) = robot.joints
    assert (joint.low, joint.high, joint.velocity, joint.torque) == (-np.inf, *[np.inf] * 3)
    assert robot.resolved["joints"][0]["position_min"] is None
    np.testing.assert_array_equal(robot.chain.joints[0].axis, [0, 0, 1])


def test_a_robot_is_resolved_again_only_after_a_change(copied, monkeypatch):
    calls = []

    def counted(arguments):
        calls.append(arguments)
        return resolved(arguments)

    resolved = robots.resolved
    monkeypatch.setattr(robots, "resolved", counted)
    there = sorted(copied.iterdir())
    assert load_robot(str(copied)).rate_hz == load_robot(str(copied)).rate_hz
    assert len(calls) == 1 and sorted(copied.iterdir()) == there, "nothing is written"
    changed(copied, "name: desktop2r", "name: other")
    assert load_robot(str(copied)).name == "other" and len(calls) == 2


def test_every_complaint_reaches_the_user_once(copied):
    changed(copied, "gear_ratio:", "gaer_ratio:")
    with pytest.raises(InputError) as refused:
        load_robot(str(copied))
    lines = str(refused.value).splitlines()
    assert len(lines) == len(set(lines)) and "robot.yaml:" in lines[0], lines
    assert any("gaer_ratio" in line for line in lines)


def test_a_log_keeps_what_was_resolved(copied, scenario_file, tmp_path):
    """Robot and scenario are those of the run, whatever becomes of their files."""
    scenario, run = load_scenario(scenario_file(str(copied), TIMELINE)), tmp_path / "run"
    run.mkdir()
    keep_scenario(scenario, run)
    shutil.rmtree(copied)
    (run / "robot.yaml").write_text("name: nothing of use\n")
    again, robot = scenario_beside(run), robot_beside(run)
    for found in (robot, again.robot):
        assert found.name == "desktop2r" and found.folder == run
        assert found.urdf == run / "robot.urdf" and found.urdf.is_file()
    np.testing.assert_array_equal(again.gains[-1].K_x, scenario.gains[-1].K_x)
    assert again.path == run / "scenario.yaml" and again.event_times == scenario.event_times


def test_a_log_of_before_is_resolved_by_its_copies(copied, scenario_file, tmp_path):
    scenario, run = load_scenario(scenario_file(str(copied), TIMELINE)), tmp_path / "run"
    run.mkdir()
    assert robot_beside(run) is None and scenario_beside(run) is None
    keep_scenario(scenario, run)
    (run / "robot.json").unlink()
    (run / "scenario.json").unlink()
    changed(copied, "name: desktop2r", "name: changed_since")
    assert robot_beside(run).name == scenario_beside(run).robot.name == "desktop2r"


@pytest.mark.parametrize("text", ['{"format": "limber-resolved-robot/9"}', "[]", "{"])
def test_a_description_of_another_form_is_refused(copied, tmp_path, text):
    run = tmp_path / "run"
    run.mkdir()
    keep_description(load_robot(str(copied)), run)
    assert json.loads((run / "robot.json").read_text())["format"] == robots.FORMAT
    (run / "robot.json").write_text(text)
    with pytest.raises(InputError, match=r"robot\.json"):
        robot_beside(run)
