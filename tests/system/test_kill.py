"""Any process may die at any time: the next layer stops the arm, a restart works, nothing jumps."""

import time

import numpy as np
import pytest

from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber.lcmtypes.joint_state_t import joint_state_t as State
from stack import SLOW_HZ

pytestmark = [pytest.mark.realtime, pytest.mark.usefixtures("judged")]
DEGREE = np.pi / 180
FALLING_rad_per_s = (
    0.6  # an undamped openarm shoulder passes this a tenth of a second after its torque is gone
)


def speeds(truths) -> np.ndarray:
    return np.array([np.abs(truth.v[: truth.num_joints]).max() for truth in truths])


def active(stack) -> None:
    stack.start_all()
    stack.bring_to(Status.MODE_ACTIVE)
    time.sleep(0.8)  # let the fade-in of the law pass


def test_controller_dies(stack):
    active(stack)
    before = stack.positions
    index = stack.user.count("SIM_TRUTH")
    states = stack.user.count("JOINT_STATE")
    stack.kill("controller")
    stack.until(lambda: stack.state.drive_state == State.DRIVE_HOLD, 5, "the drives to hold")
    time.sleep(1.0)
    # The driver notices within three cycles of the last answer and keeps the arm up by itself.
    held = [s for s in stack.user.since("JOINT_STATE", states) if s.drive_state == State.DRIVE_HOLD]
    assert held[0].fault == State.FAULT_CONTROLLER_LOST
    assert np.abs(stack.positions - before).max() < 3 * DEGREE
    assert speeds(stack.user.since("SIM_TRUTH", index)).max() < FALLING_rad_per_s
    assert speeds(stack.user.since("SIM_TRUTH", -SLOW_HZ // 2)).max() < 0.02

    # A new controller starts in INIT, moves nothing, and holds when asked, without a jump.
    held_at = stack.positions
    stack.start("controller")
    stack.until(lambda: stack.mode == Status.MODE_IDLE, 10, "the new controller to be IDLE")
    assert stack.state.drive_state == State.DRIVE_HOLD, (
        "starting a controller must not change what the drives do"
    )
    index = stack.user.count("SIM_TRUTH")
    stack.bring_to(Status.MODE_HOLD)
    stack.until(lambda: stack.state.drive_state == State.DRIVE_ON, 5, "the drives to obey again")
    time.sleep(1.0)
    assert np.abs(stack.positions - held_at).max() < 1 * DEGREE
    assert speeds(stack.user.since("SIM_TRUTH", index)).max() < 0.2


def test_driver_dies(stack):
    active(stack)
    index = stack.user.count("SIM_TRUTH")
    stack.kill("driver")
    time.sleep(2.0)
    truths = stack.user.since("SIM_TRUTH", index)
    # The motor nodes' own watchdog shorts the phases: the arm sinks slowly on passive dampers.
    assert speeds(truths).max() < 2.0
    assert stack.mode == Status.MODE_FAULT
    old = stack.state.session

    stack.start("driver")
    stack.until(lambda: stack.state.session != old, 10, "a new session")
    stack.until(lambda: stack.state.drive_state == State.DRIVE_OFF, 10, "the drives to be off")
    time.sleep(0.5)
    assert stack.mode in (Status.MODE_FAULT, Status.MODE_INIT, Status.MODE_IDLE), (
        "no motion without being asked"
    )
    stack.acknowledge()
    held_at = stack.positions
    stack.bring_to(Status.MODE_HOLD)
    time.sleep(1.5)
    assert stack.state.drive_state == State.DRIVE_ON, stack.describe()
    assert np.abs(stack.positions - held_at).max() < 12 * DEGREE, (
        "enabling ramps the torque in: it may sink a little"
    )
    assert speeds(stack.user.since("SIM_TRUTH", -SLOW_HZ // 2)).max() < 0.05


def test_simulator_dies(stack):
    active(stack)
    stack.kill("sim")
    stack.until(lambda: stack.mode == Status.MODE_FAULT, 5, "the controller to be in FAULT")
    assert stack.state.fault == State.FAULT_REPLY_LOST
    assert stack.state.drive_state in (State.DRIVE_HOLD, State.DRIVE_DAMP, State.DRIVE_FAULT)

    stack.start("sim")
    time.sleep(1.0)
    index = stack.user.count("SIM_TRUTH")
    time.sleep(0.5)
    fresh = stack.user.since("SIM_TRUTH", index)
    assert fresh, "the new simulator speaks"
    assert max(np.abs(truth.tau_motor).max() for truth in fresh) < 0.2, (
        "no torque on an arm nobody has acknowledged"
    )
    stack.acknowledge()
    stack.bring_to(Status.MODE_HOLD)
    stack.until(lambda: stack.state.drive_state == State.DRIVE_ON, 10, "drives on")


@pytest.mark.parametrize("name", ["controller", "driver", "sim"])
def test_dies_before_anything_moves(stack, name):
    """In IDLE there is nothing to hold; a restart leads back to IDLE without a request."""
    stack.start_all()
    stack.until(lambda: stack.mode == Status.MODE_IDLE, 10, "IDLE")
    stack.kill(name)
    time.sleep(0.5)
    stack.start(name)
    time.sleep(1.0)
    stack.acknowledge()
    stack.bring_to(Status.MODE_HOLD)
    stack.until(lambda: stack.state.drive_state == State.DRIVE_ON, 10, "drives on")
