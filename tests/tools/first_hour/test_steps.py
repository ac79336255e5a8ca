"""What each step of the first hour makes of what it has found."""

import shutil

import numpy as np
import pytest

from limber.first_hour import bounded, motors_step, powered, wire_step, zero_step
from limber.first_hour.record import FAILED, PASSED
from limber.model.robot import load_robot
from limber.paths import robot_folder
from limber.run import buses

BUS = [{"name": "arm", "can": "socketcan:can0", "fd": False}]
WANTED = {"arm": {"damiao_mit:1": "shoulder", "damiao_mit:2": "elbow"}}


def motors(*answers: str):
    return motors_step.judge(BUS, WANTED, {"arm": [(one, "replies as 0x11") for one in answers]})


def test_all_motors_answer_once():
    assert motors("damiao_mit:1", "damiao_mit:2").verdict == PASSED


def test_a_motor_that_is_missing_is_named_with_those_that_it_may_be():
    found = motors("damiao_mit:1", "robstride:127")
    assert found.verdict == FAILED
    assert "elbow: damiao_mit:2 on arm: no answer" in found.lines
    assert "robstride:127 on arm is not in robot.yaml" in found.lines
    assert "damiao_mit:2" in found.cure and "robstride:127" in found.cure


def test_a_number_that_is_written_twice_is_found():
    found = motors("damiao_mit:1", "damiao_mit:2", "damiao_mit:2")
    assert found.verdict == FAILED
    assert "limber motors set-id can0 damiao_mit:2 NUMBER" in found.cure


@pytest.mark.parametrize(
    ("arm", "numbers"),
    [
        ("openarm_right", [f"damiao_mit:{i}" for i in range(1, 9)]),  # with its hand
        ("antagonist2r", [f"cia402:{i}" for i in range(1, 5)]),  # two motors a joint
        ("planar2r", ["moteus:1", "moteus:2"]),
    ],
)
def test_the_motors_of_an_arm_go_by_the_numbers_of_robot_yaml(arm, numbers):
    found = motors_step.expected(load_robot(arm))
    assert [motor for bus in found.values() for motor in bus] == numbers


def test_angles_outside_of_their_travel_are_no_matter_of_opinion(monkeypatch):
    """A whole turn off, as drives that keep a single turn come up."""
    monkeypatch.setattr(zero_step, "answer", lambda *_: pytest.fail("nobody is to be asked"))
    robot = load_robot("openarm")
    theta = robot.home.copy()
    theta[3] -= 2 * np.pi
    found = zero_step.judge(robot, theta, None)
    assert found.verdict == FAILED and "joint4" in found.lines[0] and "zero" in found.cure


def test_bounds_carry_the_arm_and_stay_within_its_limits():
    robot = load_robot("openarm")
    bounds = bounded.torque_bounds(robot)
    limits = np.array([joint.torque for joint in robot.joints])
    stretched = np.abs(robot.dynamics.gravity_torque(robot.home[None])[0])
    assert (bounds <= limits).all() and (bounds > stretched).all()
    assert (bounds < 0.8 * limits).sum() >= 5  # little torque


@pytest.mark.parametrize("arm", ["desktop2r", "antagonist2r", "panda", "edulite_a3"])
def test_a_copy_with_bounds_is_the_same_arm_otherwise(arm, tmp_path):
    robot = load_robot(arm)
    copy = load_robot(str(bounded.write_bounded(robot, tmp_path)))
    assert copy.joint_names == robot.joint_names and copy.buses == robot.buses
    want = bounded.torque_bounds(robot)
    assert [joint.torque for joint in copy.joints] == pytest.approx(want, abs=6e-4)
    assert [joint.low for joint in copy.joints] == [joint.low for joint in robot.joints]


def weights(robot):
    return robot.dynamics.gravity_torque(robot.home[None])[0]


def test_the_models_weight_passes():
    robot = load_robot("openarm")
    assert powered.judge_gravity(robot, robot.home, weights(robot)).verdict == PASSED


@pytest.mark.parametrize("factor", [4, 2.5, 0.25])
@pytest.mark.parametrize("arm", ["openarm", "desktop2r", "edulite_a3"])
def test_a_torque_scale_that_is_wrong_is_named_by_its_joint(arm, factor):
    robot = load_robot(arm)
    tau = weights(robot)
    heavy = int(np.argmax(np.abs(tau) / [joint.torque for joint in robot.joints]))
    tau[heavy] *= factor
    found = powered.judge_gravity(robot, robot.home, tau)
    name = robot.joints[heavy].name
    assert found.verdict == FAILED and found.lines[0].endswith(f": {name}")
    row = next(line for line in found.lines[1:] if line.startswith(name))
    assert row.endswith(f"{factor:.2f} of it")


def test_torques_that_are_no_numbers_do_not_pass():
    robot = load_robot("openarm")
    assert powered.judge_gravity(robot, robot.home, np.full(7, np.nan)).verdict == FAILED


class Log:
    """Of a tip that is pushed by `far` and comes back to `left`, m."""

    def __init__(self, far: float, left: float) -> None:
        time_s = np.arange(0.0, powered.SOFT_S, 0.01)
        away = np.where(time_s < 2.0, 0.5, 0.0)  # before it was soft: counts as nothing
        away = np.where((time_s > 8.0) & (time_s < 12.0), far, away)
        away = np.where(time_s >= 12.0, left, away)
        self.status = np.zeros(len(time_s), [("time_ns", "i8"), ("e", "f8", 6)])
        self.status["time_ns"] = np.round(time_s * 1e9)
        self.status["e"][:, 1] = away

    def read(self, _channel: str) -> np.ndarray:
        return self.status


@pytest.mark.parametrize(
    ("far", "left", "verdict"),
    [(0.03, 0.002, PASSED), (0.0, 0.0, FAILED), (0.03, 0.028, FAILED), (np.nan, 0.0, FAILED)],
)
def test_a_push_goes_away_and_comes_back(far, left, verdict):
    assert powered.judge_push(Log(far, left)).verdict == verdict


def arm_on(folder, address: str):
    shutil.copytree(robot_folder("desktop2r"), folder)
    path = folder / "robot.yaml"
    text = path.read_text(encoding="utf-8").replace('"virtual:desktop2r"', f'"{address}"')
    path.write_text(text, encoding="utf-8")
    return load_robot(str(folder))


def test_a_serial_adapter_that_is_not_there_is_no_simulated_bus(tmp_path):
    robot = arm_on(tmp_path / "arm", f"dmserial:{tmp_path}/ttyACM0@921600")
    found = wire_step.check(robot)
    assert found.verdict == FAILED and "no such device" in found.lines[0]
    assert "/dev/serial/by-id" in found.cure
    (tmp_path / "ttyACM0").touch()
    assert wire_step.check(robot).verdict == PASSED
    assert buses.real(robot.buses) == list(robot.buses.values())
    assert robot.resolved["buses"][0]["can"].startswith("dmserial:")


def test_a_virtual_bus_is_simulated():
    found = wire_step.check(load_robot("desktop2r"))
    assert found.verdict == PASSED and found.lines == ("arm: virtual:desktop2r, simulated",)
