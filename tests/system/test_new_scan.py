"""`limber new --scan`: robot.yaml with the motors that answer on the buses of an emulated arm."""

from __future__ import annotations

import re

import pytest
import yaml
from motor_bus import forgetful_drive

from stack import ROOT
from test_motors import ARMS

SLIDES = ROOT / "tests" / "robots" / "data" / "arm" / "robot.urdf"  # three joints


@pytest.fixture
def new(limber, tmp_path):
    """Calls `limber new` for an arm's own URDF: the process, and what it wrote."""

    def call(robot: str, *words: str):
        described = ROOT / "robots" / robot
        ends = yaml.safe_load((described / "robot.yaml").read_text(encoding="utf-8"))
        urdf = str(described / ends["urdf"])
        arguments = ["--base", ends["base"], "--tip", ends["tip"], "--name", "mine", *words]
        done = limber("new", urdf, *arguments, cwd=tmp_path)
        path = tmp_path / "mine" / "robot.yaml"
        return done, path.read_text(encoding="utf-8") if path.exists() else ""

    return call


@pytest.mark.parametrize("robot", sorted(ARMS))
def test_joints_have_the_motors_that_were_found(motors, new, limber, tmp_path, robot):
    motors(robot)
    fd = ["--fd"] if robot in ("planar2r", "testbench") else []
    done, text = new(robot, "--scan", f"virtual:{robot}", *fd)
    assert done.returncode == 0, done.stderr
    own = yaml.safe_load((ROOT / "robots" / robot / "robot.yaml").read_text(encoding="utf-8"))
    made = yaml.safe_load(text)
    assert list(made["joints"]) == list(own["joints"])
    by_number = sorted(own["joints"].values(), key=lambda joint: int(str(joint["id"]), 0))
    for joint, truth in zip(made["joints"].values(), by_number, strict=True):
        assert (joint["id"], joint.get("reply_id")) == (truth["id"], truth.get("reply_id"))
        motor, true = made["motors"][joint["motor"]], own["motors"][truth["motor"]]
        assert motor["protocol"] == true["protocol"]
        for key in ("rated_torque_Nm", "firmware", "pid_position"):
            assert motor.get(key) == pytest.approx(true.get(key)), key
        if "counts_per_turn" in motor:
            assert motor["counts_per_turn"] == 2 ** true["encoder_bits"]
        assert ("counts_per_turn" in motor) == (motor["protocol"] == "cia402")
        for key in ("position_rad", "velocity_rad_per_s", "torque_Nm"):
            assert motor.get("mit_range", {}).get(key) == true.get("mit_range", {}).get(key)
        assert joint["id"] in (int(n) for n in re.findall(r":(\d+) on virtual", done.stdout))
    assert f"# found on virtual:{robot}" in text and "guess: found on" in text
    assert "in order of number, a guess" in done.stdout
    assert limber("check", "mine", cwd=tmp_path).returncode == 0
    run = limber("lab", "mine_first.yaml", "--out", "run", cwd=tmp_path)
    assert run.returncode == 0, run.stdout + run.stderr


def test_another_count_of_motors_is_left_to_the_person(motors, limber, tmp_path):
    motors("desktop2r")
    words = ["--base", "base", "--tip", "hand", "--name", "mine", "--scan", "virtual:desktop2r"]
    done = limber("new", str(SLIDES), *words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "found 2 motors for 3 joints: listed in robot.yaml for you to assign" in done.stdout
    text = (tmp_path / "mine" / "robot.yaml").read_text(encoding="utf-8")
    listed = [line for line in text.splitlines() if line.startswith("#   ")]
    assert [line.split(",")[0] for line in listed] == [
        "#   damiao_mit:1 on virtual:desktop2r",
        "#   damiao_mit:2 on virtual:desktop2r",
    ]
    assert "motors.*.mit_range.torque_Nm: 10" in listed[0]
    assert "found on" not in text.replace("\n".join(listed), "")
    assert limber("check", "mine", cwd=tmp_path).returncode == 0


def test_only_one_family(motors, new):
    """The hand of axol is another family's; and five motors are not one a joint."""
    motors("axol")
    done, text = new("axol", "--scan", "virtual:axol", "--drives", "myactuator")
    assert done.returncode == 0, done.stderr
    assert "found 5 motors for 7 joints" in done.stdout
    assert "damiao" not in text


def test_nothing_is_made_without_motors(motors, new):
    done, text = new("desktop2r", "--scan", "virtual:nobody")
    assert done.returncode == 2 and "no motor answers on virtual:nobody" in done.stderr
    done, text = new("desktop2r")
    assert done.returncode == 2 and "--scan BUS" in done.stderr
    motors("desktop2r")
    done, text = new("desktop2r", "--scan", "virtual:desktop2r", "--drives", "robstride")
    assert done.returncode == 2 and "no RobStride motor answers" in done.stderr
    with forgetful_drive("desktop2r"):
        done, text = new("desktop2r", "--scan", "virtual:desktop2r")
    assert done.returncode == 2 and "two motors answer" in done.stderr
    assert text == ""
