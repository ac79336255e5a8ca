"""Somebody writes a setting of a drive while the arm runs, with a tool on the same bus: the drives
hold the arm, whatever the setting, and the joint is named.
"""

from dataclasses import dataclass

import can
import pytest
from local_drive import multicast_group

from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber.lcmtypes.joint_state_t import joint_state_t as State

JOINT = 1  # its drive has number 2 on each of these arms


@dataclass(frozen=True)
class Write:
    robot: str
    id: int
    data: bytes
    fd: bool = False
    bus: str = ""  # named as the robot, else


def damiao(operation: int, register: int, value: str = "00002041") -> Write:
    """`value`: four bytes; 10 as a float."""
    data = bytes([2, 0, operation, register]) + bytes.fromhex(value)
    return Write("desktop2r", 0x7FF, data)


def moteus(line: bytes) -> Write:
    """To the diagnostic channel, as the maker's tool does it; the rest of the frame is NOPs."""
    data = bytes([0x40, 1, len(line)]) + line
    return Write("planar2r", 0x8002, data.ljust(64, b"\x50"), fd=True)


def canopen(data: str, id: int = 0x602) -> Write:
    return Write("panda", id, bytes.fromhex(data), bus="panda_shoulder")


WRITES = {
    "Damiao, TMAX": damiao(0x55, 23),
    "Damiao, mode": damiao(0x55, 10, "02000000"),
    "Damiao, its own number": damiao(0x55, 8, "09000000"),
    "Damiao, zero": Write("desktop2r", 2, bytes.fromhex("FFFFFFFFFFFFFFFE")),
    "moteus, a gain": moteus(b"conf set servo.pid_position.kp 9\n"),
    "moteus, its number": moteus(b"conf set id.id 9\n"),
    "CiA 402, mode": canopen("2F60600008000000"),
    "CiA 402, a mapping": canopen("2F001A0000000000"),
    "CiA 402, a reset": canopen("8102", id=0),
}


@pytest.mark.parametrize("write", WRITES.values(), ids=WRITES)
def test_a_setting_that_somebody_writes(stack, write):
    stack.robot = write.robot
    stack.start_all()
    stack.bring_to(Status.MODE_ACTIVE)
    begun = stack.user.count("JOINT_STATE")
    group = multicast_group(write.bus or write.robot)
    with can.Bus(interface="udp_multicast", channel=group, hop_limit=0, fd=True) as tool:
        extended = write.id > 0x7FF
        tool.send(
            can.Message(
                arbitration_id=write.id, is_extended_id=extended, data=write.data, is_fd=write.fd
            )
        )
        stack.until(lambda: stack.state.drive_state != State.DRIVE_ON, 20, "a reaction")
    states = stack.user.since("JOINT_STATE", begun)
    first = next(state for state in states if state.drive_state != State.DRIVE_ON)
    assert first.drive_state == State.DRIVE_HOLD
    assert first.fault == State.FAULT_FOREIGN_COMMAND
    assert first.fault_joint == JOINT
    stack.pass_time(0.2)
    assert stack.processes["driver"].poll() is None
