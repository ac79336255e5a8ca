"""The simulated Damiao motors, as somebody else's client sees them: all four control modes."""

from __future__ import annotations

import time

import can
import pytest
from damiao_motor import DaMiaoController
from local_drive import multicast_group

SHOULDER, REPLIES = 1, 0x11  # of desktop2r
ELBOW = 2, 0x12
CONTROL_MODE = 10


class Client(DaMiaoController):
    """As it is, but for the bus: the package hands over no more than two arguments."""

    def __init__(self, group: str) -> None:
        can.rc.update({"hop_limit": 0})
        super().__init__(channel=group, bustype="udp_multicast")


@pytest.fixture
def shoulder(stack):
    stack.robot = "desktop2r"
    stack.pace = "--realtime"
    stack.start("sim", "--realtime")
    stack.until(lambda: stack.truth is not None, 20, "the simulator")
    client = Client(multicast_group("desktop2r"))
    client.add_motor(*ELBOW, "4310").enable()  # the arm lies in its stand until all are enabled
    yield client.add_motor(SHOULDER, REPLIES, "4310")
    client.shutdown()


def repeat(stack, send, until, seconds: float = 15.0) -> None:
    """Sends as a client does, again and again, until the arm is where it should be."""
    end = time.monotonic() + seconds
    while not until(stack.truth) and time.monotonic() < end:
        send()
        time.sleep(0.01)
    assert until(stack.truth), stack.truth.q


def await_register(motor, number: int, value: float) -> None:
    """The package takes its own request, which it hears, for an answer of 0 until that comes."""
    end = time.monotonic() + 20.0
    while motor.get_register(number) != value:
        assert time.monotonic() < end, motor.get_register(number)
        time.sleep(0.1)
        motor.registers.clear()


def enable_in(motor, mode: int) -> None:
    """Without the package's ensure_control_mode, which reads its own memory of the register."""
    motor.write_register(CONTROL_MODE, mode)
    time.sleep(0.1)
    motor.registers.clear()
    await_register(motor, CONTROL_MODE, mode)
    motor.enable()


def test_position_velocity(stack, shoulder):
    begin = stack.truth.q[0]
    enable_in(shoulder, 2)
    repeat(
        stack,
        lambda: shoulder.send_cmd_pos_vel(begin + 0.3, 1.0),
        lambda truth: abs(truth.q[0] - begin - 0.3) < 0.02,
    )
    assert shoulder.get_states()["pos"] == pytest.approx(begin + 0.3, abs=0.03)


def test_velocity(stack, shoulder):
    begin = stack.truth.q[0]
    enable_in(shoulder, 3)
    repeat(stack, lambda: shoulder.send_cmd_vel(0.5), lambda truth: truth.q[0] > begin + 0.2)


def test_force_position(stack, shoulder):
    begin = stack.truth.q[0]
    enable_in(shoulder, 4)
    repeat(
        stack,
        lambda: shoulder.send_cmd_force_pos(begin + 0.2, 1.0, 0.9),
        lambda truth: abs(truth.q[0] - begin - 0.2) < 0.02,
    )


def test_registers_are_checked_and_identifiers_move(shoulder):
    shoulder.write_register(9, 8000)
    await_register(shoulder, 9, 8000)
    shoulder.write_register(2, 500.0)  # degC: too hot
    shoulder.registers.clear()
    await_register(shoulder, 2, 100.0)
    shoulder.write_register(8, 6)
    time.sleep(0.2)
    moved = shoulder._controller.add_motor(6, REPLIES, "4310")
    await_register(moved, 8, 6)
