"""What the driver's messages allow: readings while every drive is off, else an end at once."""

import numpy as np
import pytest
from made_logs import records

from limber import messages
from limber.errors import RunError
from limber.joint_check import drives
from limber.joint_check.drives import Drives
from limber.model.robot import load_robot

KINDS = messages.message_class("joint_state_t")


class Silent:
    """A receiver with the messages that a test puts into it."""

    def __init__(self) -> None:
        self.waiting: list[np.ndarray] = []

    def stream(self, _channel: str) -> "Silent":
        return self

    def read(self) -> np.ndarray:
        parts, self.waiting = self.waiting, []
        return np.concatenate(parts) if parts else np.zeros(0)


def states(count: int = 1, **fields) -> np.ndarray:
    given = {"num_joints": 2, "drive_state": KINDS.DRIVE_OFF, "fault_joint": -1, **fields}
    made = records("joint_state_t", count, **given)
    if "joint_flags" not in fields:
        made["joint_flags"][:, :2] = KINDS.JOINT_FRESH
    return made


@pytest.fixture
def receiver():
    return Silent()


@pytest.fixture
def heard(receiver):
    return Drives(load_robot("planar2r"), receiver, None)


def test_readings(heard, receiver):
    assert heard.read() is None
    made = states(3, time_ns=[1e9, 2e9, 3e9])
    made["theta"][:, 0] = 0.1, 0.2, 0.3
    made["q"][:, 0] = 0.1, 0.2, 0.35
    receiver.waiting.append(made)
    found = heard.read()
    assert found.time_s == 3.0 and found.fresh.all() and len(found.theta) == 2
    assert found.theta[0] == 0.3 and found.apart[0] == pytest.approx(0.05)


def test_the_newest_fresh_reading_of_each_joint(heard, receiver):
    made = states(3)
    made["theta"][:, :2] = [[1, 4], [2, 5], [3, 6]]
    made["joint_flags"][2, 0] = made["joint_flags"][:, 1] = 0
    receiver.waiting.append(made)
    found = heard.read()
    assert found.theta[0] == 2 and list(found.fresh) == [True, False]


def test_drives_that_are_being_configured_are_waited_for(heard, receiver):
    receiver.waiting.append(states(drive_state=KINDS.DRIVE_CONFIGURING))
    assert heard.read() is None and "settings" in heard.awaited
    receiver.waiting.append(states())
    assert heard.read() is not None


@pytest.mark.parametrize("state", ["ENABLING", "ON", "HOLD", "DAMP", "FAULT"])
def test_powered_drives_are_refused(heard, receiver, state):
    receiver.waiting.append(states(drive_state=getattr(KINDS, f"DRIVE_{state}")))
    with pytest.raises(RunError, match=f"the drives are {state}, not OFF"):
        heard.read()


@pytest.mark.parametrize("state", ["CONFIGURING", "ENABLING", "ON", "HOLD", "DAMP", "FAULT"])
def test_one_message_between_others_is_enough(heard, receiver, state):
    receiver.waiting.append(states())
    heard.read()
    for number in (KINDS.DRIVE_OFF, getattr(KINDS, f"DRIVE_{state}"), KINDS.DRIVE_OFF):
        receiver.waiting.append(states(drive_state=number))
    with pytest.raises(RunError, match=f"have become {state}, not OFF: take your hands off"):
        heard.read()


def test_a_single_enabled_drive(heard, receiver):
    made = states()
    made["joint_flags"][0, 1] |= KINDS.JOINT_ENABLED
    receiver.waiting.append(made)
    with pytest.raises(RunError, match="the drive of elbow is enabled"):
        heard.read()


def test_a_fault_is_in_words(heard, receiver):
    receiver.waiting.append(states(drive_state=KINDS.DRIVE_FAULT, fault=KINDS.FAULT_CONFIGURATION))
    with pytest.raises(RunError, match=r"driver\.CONFIGURATION: .* To do: "):
        heard.read()


def test_another_arm(heard, receiver):
    receiver.waiting.append(states(num_joints=7))
    with pytest.raises(RunError, match="an arm of 7 joints, planar2r has 2"):
        heard.read()


def test_silence(heard, receiver, monkeypatch):
    receiver.waiting.append(states())
    heard.read()
    later = drives.time.monotonic() + 6.0
    monkeypatch.setattr(drives.time, "monotonic", lambda: later)
    with pytest.raises(RunError, match="silent for 6 s"):
        heard.read()
