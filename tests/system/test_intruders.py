"""Only the bound controller's fresh answers are obeyed; all else is refused and counted."""

import math
import time
from contextlib import closing

import lcm
import numpy as np
import pytest

from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber.lcmtypes.driver_status_t import driver_status_t as Driver
from limber.lcmtypes.joint_command_t import joint_command_t
from limber.lcmtypes.joint_state_t import joint_state_t as State
from stack import ARM_URL, Listener

pytestmark = [pytest.mark.realtime, pytest.mark.usefixtures("judged")]


def active(stack) -> None:
    stack.start_all()
    stack.bring_to(Status.MODE_ACTIVE)
    time.sleep(0.8)


def refused(stack, verdict: int) -> int:
    return stack.driver_status.commands_refused[verdict]


def still_obeyed(stack, before) -> None:
    assert stack.state.drive_state == State.DRIVE_ON
    assert stack.mode == Status.MODE_ACTIVE
    assert np.abs(np.array(stack.truth.q) - before).max() < 0.01


def test_second_controller(stack):
    active(stack)
    before = np.array(stack.truth.q)
    bound = stack.user.latest("JOINT_TORQUE").controller  # of the only one yet
    stack.start("controller", tag="second")
    stack.until(
        lambda: refused(stack, Driver.VERDICT_CONTROLLER) > 100,
        10,
        "the second controller to be refused",
    )
    assert bound != 0
    assert f", and {bound} has the arm; end one of them" in stack.log("driver")
    assert stack.state.drive_state == State.DRIVE_ON
    assert np.abs(np.array(stack.truth.q) - before).max() < 0.01


def test_replayed_commands(stack):
    with closing(Listener(ARM_URL)) as arm:
        active(stack)
        old = (500 * list(arm.raw["JOINT_TORQUE"]))[:500]
        before = np.array(stack.truth.q)
        replayed = refused(stack, Driver.VERDICT_REPLAYED) + refused(stack, Driver.VERDICT_STALE)
        for data in old:
            arm.lcm.publish("JOINT_TORQUE", data)
            time.sleep(0.0005)
    stack.until(
        lambda: (
            refused(stack, Driver.VERDICT_REPLAYED) + refused(stack, Driver.VERDICT_STALE)
            >= replayed + 400
        ),
        10,
        "replayed commands to be counted",
    )
    still_obeyed(stack, before)


def forge(stack, **changes) -> bytes:
    """An answer as the bound controller could give it now, with some fields changed."""
    genuine = stack.user.latest("JOINT_TORQUE")
    message = joint_command_t.decode(genuine.encode())
    message.state_seq = stack.state.seq + 1
    for name, value in changes.items():
        setattr(message, name, value)
    return message.encode()


def test_not_a_number(stack):
    active(stack)
    arm = lcm.LCM(ARM_URL)
    count = refused(stack, Driver.VERDICT_NOT_FINITE)
    stack.processes["controller"].kill()  # its answers would come first
    tau = [math.nan] + [0.0] * 15
    end = time.monotonic() + 10
    while refused(stack, Driver.VERDICT_NOT_FINITE) <= count and time.monotonic() < end:
        arm.publish("JOINT_TORQUE", forge(stack, tau=tau, state_seq=stack.state.seq))
        time.sleep(0.003)
    assert refused(stack, Driver.VERDICT_NOT_FINITE) > count
    for state in stack.user.since("JOINT_STATE", -1000):
        assert all(math.isfinite(value) for value in (*state.q, *state.v, *state.tau_applied))


def test_wrong_session(stack):
    active(stack)
    before = np.array(stack.truth.q)
    arm = lcm.LCM(ARM_URL)
    count = refused(stack, Driver.VERDICT_SESSION)
    for _ in range(100):
        arm.publish("JOINT_TORQUE", forge(stack, session=12345))
        time.sleep(0.002)
    stack.until(
        lambda: refused(stack, Driver.VERDICT_SESSION) >= count + 90,
        10,
        "the wrong session to be counted",
    )
    still_obeyed(stack, before)


def test_garbage_on_the_arm_plane(stack):
    active(stack)
    before = np.array(stack.truth.q)
    arm = lcm.LCM(ARM_URL)
    rng = np.random.default_rng(1)
    genuine = stack.user.raw["JOINT_TORQUE"][-1]
    for size in (0, 1, 7, 8, 100, len(genuine) - 1, len(genuine) + 1, 1399, 20000):
        for _ in range(20):
            arm.publish("JOINT_TORQUE", rng.bytes(size))
            arm.publish("JOINT_STATE", rng.bytes(size))
            time.sleep(0.0005)
    time.sleep(0.5)
    still_obeyed(stack, before)
