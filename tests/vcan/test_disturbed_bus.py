"""The stack on the kernel's CAN while can-utils and the kernel's network emulator disturb it.

The driver is on vxcan0 and the simulator at the other end of the cable, vxcan1. What is tested is
the reaction, not the machine, for which the arm waits (lock step at the clock's pace). Only late
replies need real time.
"""

import subprocess

import numpy as np
import pytest
from processes import started

from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber.lcmtypes.joint_state_t import joint_state_t as State
from slow_arm import slow_arm

REPLIES = "-s vcan1 -d vcan0 -e -f 010:7F0"
ALL_ELSE = "-s vcan1 -d vcan0 -e -f 010~7F0"
DELAY = "tc qdisc {} dev vxcan1 root netem delay {}ms limit 1000"


def sh(command: str) -> None:
    subprocess.run(command, shell=True, check=True, timeout=30)


def start(stack, driver: str, simulator: str, pace: str):
    """Brings the arm to ACTIVE, driver and simulator each on an interface of its own."""
    stack.pace, stack.robot = pace, str(slow_arm(stack.directory / "arm"))
    stack.start("sim", "--bus", f"arm=socketcan:{simulator}")
    stack.start("controller")
    if pace == "--realtime":  # else it waits for the driver
        stack.until(lambda: stack.truth is not None, 60, "the simulator")
    stack.start("driver", "--bus", f"arm=socketcan:{driver}")
    stack.until(lambda: stack.mode is not None, 60, "the controller to hear the driver")
    stack.bring_to(Status.MODE_ACTIVE)
    stack.until(lambda: stack.driver_status is not None, 20, "the driver's status")
    return stack


@pytest.fixture
def cable():
    """Between two interfaces."""
    yield
    subprocess.run("tc qdisc del dev vxcan1 root", shell=True, check=False, capture_output=True)


@pytest.fixture
def arm(stack, cable):
    return start(stack, "vxcan0", "vxcan1", "--paced")


@pytest.fixture
def arm_in_real_time(stack, cable):
    return start(stack, "vxcan0", "vxcan1", "--realtime")


@pytest.fixture
def gateway(stack):
    """The bus is a gateway between two buses, which never stays behind: it would copy the frames of
    every later test. Replies of the drives have a rule of their own.
    """
    sh("cangw -F")
    try:
        sh("cangw -A -s vcan0 -d vcan1 -e")
        sh(f"cangw -A {REPLIES} && cangw -A {ALL_ELSE}")
        yield start(stack, "vcan0", "vcan1", "--paced")
    finally:
        sh("cangw -F")


def test_a_flood_of_foreign_frames_is_not_even_heard(arm):
    """The kernel's filters let through what concerns this arm."""
    sh("exec cangen vxcan1 -g 2 -I 5A5 -L 8 -D r -n 500")
    arm.pass_time(2.5)
    assert arm.driver_status.frames_foreign[0] == 0
    assert arm.state.drive_state == State.DRIVE_ON
    assert arm.mode == Status.MODE_ACTIVE


def test_random_replies_in_the_name_of_a_drive_move_nothing(arm):
    """Most are unreadable or impossible. Whether the drives hold depends on when they come."""
    before = np.array(arm.truth.q[:2])
    with started("exec cangen vxcan1 -g 5 -I 011 -L 8 -D r -n 400", shell=True) as flood:
        flood.wait(timeout=60)
    arm.pass_time(0.5)
    assert np.abs(np.array(arm.truth.q[:2]) - before).max() < 0.02
    assert arm.state.drive_state in (State.DRIVE_ON, State.DRIVE_HOLD)


def test_commands_of_another_program_are_a_fault(arm):
    sh("cansend vxcan1 001#7FFF7FF000000FFF")
    arm.until(lambda: arm.state.drive_state == State.DRIVE_HOLD, 20, "the drives to hold")
    assert arm.state.fault == State.FAULT_FOREIGN_COMMAND


def test_every_frame_twice_is_a_fault(arm):
    """A loop in the wiring or a gateway: ten doubled replies within a second."""
    sh("tc qdisc add dev vxcan1 root netem duplicate 100%")
    arm.until(lambda: arm.state.drive_state == State.DRIVE_HOLD, 20, "the drives to hold")
    assert arm.state.fault == State.FAULT_REPLY_INVALID


def test_a_gateway_is_transparent_until_it_copies(gateway):
    assert gateway.state.drive_state == State.DRIVE_ON
    sh("cangw -A -s vcan1 -d vcan0 -e -f 011:7FF -m AND:D:0.8.FFFFFFFFFFFFFFFF")
    gateway.until(lambda: gateway.state.drive_state == State.DRIVE_HOLD, 20, "the drives to hold")
    assert gateway.state.fault == State.FAULT_REPLY_INVALID


def test_lost_replies_are_a_fault(gateway):
    sh(f"cangw -D {REPLIES}")
    gateway.until(lambda: gateway.state.drive_state == State.DRIVE_HOLD, 20, "the drives to hold")
    assert gateway.state.fault == State.FAULT_REPLY_LOST
    sh(f"cangw -A {REPLIES}")
    gateway.acknowledge()


def test_late_replies_are_counted_and_used(arm_in_real_time):
    """Of a period of 40 ms the window is 24 ms: 8 ms are within it, 32 ms behind it."""
    arm = arm_in_real_time
    sh(DELAY.format("add", 8))
    arm.pass_time(3.0)
    assert arm.state.drive_state == State.DRIVE_ON, arm.describe()
    late = sum(arm.driver_status.replies_late)
    sh(DELAY.format("change", 32))
    arm.until(lambda: sum(arm.driver_status.replies_late) > late + 50, 20, "late replies")
    assert arm.state.drive_state == State.DRIVE_ON, arm.describe()
    arm.until(lambda: list(arm.state.age_cycles[:2]) == [1, 1], 20, "replies one cycle old")
