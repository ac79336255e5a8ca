"""The driver with a CANopen drive that it does not know: canopen's LocalNode, unchanged."""

from __future__ import annotations

import math
import re
import time

import pytest
import yaml
from local_drive import COUNTS, ENABLED, GEAR, LocalDrive, bus, multicast_group

from limber.lcmtypes.controller_status_t import controller_status_t
from limber.lcmtypes.joint_state_t import joint_state_t
from stack import ROOT

PORT = 43113
TESTBENCH = ROOT / "robots" / "testbench"
RATE_HZ = 25  # what Python answers in time, whatever else the machine does
RATED_NM = 6.2


def off_the_shelf(robot: dict) -> dict:
    """Classic CAN; a motor's encoder before a gear; none of limber's own objects."""
    robot["urdf"] = str(TESTBENCH / "robot.urdf")
    robot["rate_hz"] = RATE_HZ
    robot["buses"] = [{"name": "arm", "can": "virtual:localdrive", "bitrate_bps": 1000000}]
    robot["watchdog"] = {"timeout_s": 0.5, "reaction": "damp"}
    motor = robot["motors"]["bench"]
    del motor["encoder_bits"]
    motor["counts_per_turn"] = COUNTS * GEAR
    joint = robot["joints"]["joint"]
    for sensor in ("link_encoder", "torque_sensor", "torque_loop"):
        del joint[sensor]
    joint["transmission"] = {"kind": "rigid"}
    joint["hold"] = {"kp_Nm_per_rad": 10, "kd_Nms_per_rad": 1}
    robot["gains"]["K_q_Nm_per_rad"] = 5
    return robot


@pytest.fixture
def drive(stack, tmp_path):
    robot = yaml.safe_load((TESTBENCH / "robot.yaml").read_text(encoding="utf-8"))
    (tmp_path / "robot.yaml").write_text(yaml.safe_dump(off_the_shelf(robot)), encoding="utf-8")
    stack.robot = str(tmp_path)
    network = bus(PORT, multicast_group("localdrive"), fd=False)
    yield LocalDrive(network, str(TESTBENCH / "drive.eds"))
    network.disconnect()


def invalid_replies(stack) -> int:
    """Until now: of the next status, which comes every 100 cycles."""
    before = stack.user.count("DRIVER_STATUS")
    stack.until(lambda: stack.user.count("DRIVER_STATUS") > before, 20, "the driver's status")
    return stack.driver_status.replies_invalid[0]


@pytest.mark.realtime
def test_it_comes_up_is_enabled_and_holds(stack, drive):
    stack.start("controller")
    time.sleep(0.3)
    stack.start("driver")
    stack.until(
        lambda: stack.state is not None and stack.state.drive_state == joint_state_t.DRIVE_OFF,
        30,
        "the start-up dialogue",
    )
    # Of the dialogue: a drive that is slow to answer gets the request twice and answers twice.
    invalid_at_start = invalid_replies(stack)
    stack.bring_to(controller_status_t.MODE_HOLD)
    stack.until(lambda: stack.state.drive_state == joint_state_t.DRIVE_ON, 10, "the drive")
    assert drive.values[0x6041] == ENABLED
    # 0.01 rad away from where it is held: 5 N m/rad pull it back, 8 thousandths of 6.2 N m.
    drive.values[0x6064] = round(0.01 / (2 * math.pi) * COUNTS * GEAR)
    stack.until(lambda: drive.torque == -round(1000 * 0.05 / RATED_NM), 10, "the torque to hold")
    assert stack.state.theta[0] == pytest.approx(0.01, abs=1e-6)
    assert stack.state.drive_state == joint_state_t.DRIVE_ON
    assert invalid_replies(stack) == invalid_at_start


@pytest.mark.realtime
def test_what_the_drive_lacks_is_told(stack, drive):
    stack.start("driver")
    stack.until(
        lambda: stack.state is not None and stack.state.drive_state == joint_state_t.DRIVE_OFF,
        30,
        "the start-up dialogue",
    )
    log = stack.log("driver")
    assert "joint (node 1): object 1400h:05 is missing" in log
    missing = re.findall(r"object (\S+) is missing", log)
    assert missing == ["1400h:05", "6007h:00", "605Eh:00", "60C2h:01", "60C2h:02"]


def test_the_emulated_drive_on_classic_can(stack, tmp_path):
    """With link encoder and torque sensor: a state of three frames."""
    robot = yaml.safe_load((TESTBENCH / "robot.yaml").read_text(encoding="utf-8"))
    robot["urdf"] = str(TESTBENCH / "robot.urdf")
    robot["buses"] = [{"name": "arm", "can": "virtual:testbench", "bitrate_bps": 1000000}]
    (tmp_path / "robot.yaml").write_text(yaml.safe_dump(robot), encoding="utf-8")
    stack.robot = str(tmp_path)
    stack.start_all()
    stack.bring_to(controller_status_t.MODE_HOLD)
    stack.until(lambda: stack.state.drive_state == joint_state_t.DRIVE_ON, 10, "the drive")
    stack.until(lambda: stack.state.age_cycles[0] == 0, 10, "a state of this cycle")
    assert "missing" not in stack.log("driver")
