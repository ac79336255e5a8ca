"""Processes that get no memory any more, at the moment when something goes wrong: lines of the log
may be lost, the arm is held.
"""

import resource

import numpy as np
import pytest

from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber.lcmtypes.joint_state_t import joint_state_t as State
from limber.lcmtypes.scenario_event_t import scenario_event_t as Event

HELD_RAD = 0.1


def fail(stack, kind: int) -> None:
    """The first joint's drive, for a while."""
    event = Event()
    event.seq = 1
    event.kind, event.fault, event.joint, event.duration_s = Event.EVENT_FAULT, kind, 0, 0.3
    stack.user.lcm.publish("SCENARIO_EVENT", event.encode())


def take_memory(process) -> None:
    resource.prlimit(process.pid, resource.RLIMIT_DATA, (0, 0))


@pytest.mark.parametrize("without", ["driver", "controller"])
@pytest.mark.parametrize("kind", [Event.FAULT_SILENT, Event.FAULT_DRIVE_ERROR])
def test_a_drive_that_fails(stack, without, kind):
    stack.start_all()
    stack.bring_to(Status.MODE_ACTIVE)
    take_memory(stack.processes[without])
    before = stack.positions
    fail(stack, kind)
    stack.until(lambda: stack.state.drive_state == State.DRIVE_HOLD, 20, "FALLBACK")
    stack.pass_time(1.0)
    assert stack.processes[without].poll() is None, stack.describe()
    # A drive in error holds nothing.
    held = slice(1 if kind == Event.FAULT_DRIVE_ERROR else 0, None)
    assert np.abs(stack.positions - before)[held].max() < HELD_RAD


@pytest.mark.realtime
def test_a_controller_that_dies(stack):
    stack.start_all()
    stack.bring_to(Status.MODE_ACTIVE)
    take_memory(stack.processes["driver"])
    before = stack.positions
    stack.kill("controller")
    stack.until(lambda: stack.state.drive_state == State.DRIVE_HOLD, 20, "FALLBACK")
    stack.pass_time(1.0)
    assert stack.processes["driver"].poll() is None, stack.describe()
    assert np.abs(stack.positions - before).max() < HELD_RAD
