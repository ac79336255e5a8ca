"""What the page tells about the arm's state."""

import numpy as np
import pytest

from limber.messages import message_class
from limber.monitor.feed import NEVER_S
from limber.monitor.status_card import Shown, card
from limber.monitor.words import BAD, GOOD, WARN, Note, situation

STATE, STATUS = message_class("joint_state_t"), message_class("controller_status_t")


class Quiet:
    """A feed of one message of each channel, of the given age."""

    def __init__(self, records, ages=(0.0, 0.0), **fields) -> None:
        self.newest = {
            "JOINT_STATE": records("joint_state_t", 1, num_joints=2)[0],
            "CONTROLLER_STATUS": records("controller_status_t", 1, num_joints=2)[0],
        }
        for key, value in fields.items():
            channel = "JOINT_STATE" if key in self.newest["JOINT_STATE"].dtype.names else None
            self.newest[channel or "CONTROLLER_STATUS"][key] = value
        self._ages = dict(zip(self.newest, ages, strict=True))

    def age_s(self, channel):
        return self._ages.get(channel, NEVER_S)


@pytest.fixture
def feed():
    from limber import messages

    def records(type_name, count, **fields):
        made = np.zeros(count, messages.native_dtype_of(type_name))
        for name, value in fields.items():
            made[name] = value
        return made

    return lambda *ages, **fields: Quiet(records, ages or (0.0, 0.0), **fields)


def test_a_running_law_is_good(feed):
    now = situation(feed(mode=STATUS.MODE_ACTIVE), ["a", "b"])
    assert (now.level, now.headline, now.notes) == (GOOD, "ACTIVE", [])


@pytest.mark.parametrize(
    ("ages", "headline"),
    [
        ((NEVER_S, NEVER_S), "NO STACK"),
        ((0.9, 0.1), "NO DRIVER"),
        ((0.1, 0.9), "NO CONTROLLER"),
    ],
)
def test_silence_is_shown_within_a_second(feed, ages, headline):
    now = situation(feed(*ages, mode=STATUS.MODE_ACTIVE), [])
    assert (now.level, now.headline) == (BAD, headline)


def test_a_fault_names_joint_and_remedy(feed):
    now = situation(
        feed(mode=STATUS.MODE_FAULT, fault=STATE.FAULT_REPLY_LOST, fault_joint=1), ["a", "elbow"]
    )
    assert now.level == BAD
    (note,) = now.notes
    assert note.code == "driver.REPLY_LOST (elbow)"
    assert "check power, cable" in note.do


def test_what_the_user_wanted_is_no_fault(feed):
    now = situation(
        feed(
            mode=STATUS.MODE_HOLD,
            reason=STATUS.REASON_STOP_REQUESTED,
            reason_joint=-1,
            fault=STATE.FAULT_REQUESTED,
            fault_joint=-1,
        ),
        [],
    )
    assert now.level == GOOD
    assert [note.level for note in now.notes] == [WARN, WARN]


def test_a_limit_that_acted_a_moment_ago_is_shown(feed):
    now = situation(feed(mode=STATUS.MODE_ACTIVE), [], STATUS.LIMIT_SPRING)
    assert [note.code for note in now.notes] == ["limit.SPRING"]


def test_words_from_outside_are_escaped(feed):
    now = situation(
        feed(mode=STATUS.MODE_FAULT, fault=STATE.FAULT_POSITION, fault_joint=0),
        ["<script>alert(1)</script>"],
    )
    answer = Note(WARN, "", "<a>answer")
    shown = Shown(now, ["<b>law"], ["<i>hint"], ["<u>key"], [answer], control=True)
    html = "".join(card(shown))
    assert "<a>answer" not in html and "<u>key" not in html
    assert "<script>" not in html and "<b>law" not in html and "<i>hint" not in html
    assert "&lt;script&gt;" in html


def test_the_cause_comes_first(feed):
    """A stop that somebody asked for is no cause, and what follows from a fault none either."""
    asked = feed(mode=STATUS.MODE_FAULT, fault=STATE.FAULT_REQUESTED, reason=STATUS.REASON_STRAYED)
    codes = [note.code.split(" ")[0] for note in situation(asked, ["a", "b"]).notes]
    assert codes == ["controller.STRAYED", "driver.REQUESTED"]
    fault = STATE.FAULT_REPLY_LOST
    broken = feed(mode=STATUS.MODE_FAULT, fault=fault, reason=STATUS.REASON_DRIVER_FAULT)
    notes = situation(broken, ["a", "b"], STATUS.LIMIT_TORQUE).notes
    codes = [note.code.split(" ")[0] for note in notes]
    assert codes == ["driver.REPLY_LOST", "controller.DRIVER_FAULT", "limit.TORQUE"]
    pressed = feed(mode=STATUS.MODE_ESTOP, fault=fault, emergency_stop=STATE.STOP_PRESSED)
    assert situation(pressed, ["a", "b"]).notes[0].code.startswith("stop.")


def test_joints_with_the_same_trouble_share_a_note(feed):
    flags = np.zeros(16, int)
    flags[:2] = STATE.JOINT_DRIVE_ERROR
    now = situation(feed(mode=STATUS.MODE_HOLD, joint_flags=flags, num_joints=2), ["a", "b"])
    assert [note.code for note in now.notes] == ["joint.DRIVE_ERROR (a, b)"]


@pytest.mark.parametrize("channel", ["JOINT_STATE", "CONTROLLER_STATUS"])
def test_a_message_that_is_heard_and_not_taken_yet_is_no_error(feed, channel):
    """Another thread receives."""
    hearing = feed(mode=STATUS.MODE_ACTIVE)
    del hearing.newest[channel]
    assert situation(hearing, []).headline.startswith("NO ")


@pytest.mark.parametrize("mode", ["FAULT", "IDLE"])
def test_a_drive_that_let_go_is_enabled_only_after_idle(feed, mode):
    """`hold` enables all or none, and those that hold the arm are not switched off for it."""
    flags = np.zeros(16, int)
    flags[:2] = STATE.JOINT_ENABLED
    modes = {"mode": getattr(STATUS, f"MODE_{mode}"), "drive_state": STATE.DRIVE_HOLD}
    whole = situation(feed(**modes, joint_flags=flags), ["a", "b"])
    assert "idle" not in whole.detail
    flags[1] = STATE.JOINT_DRIVE_ERROR
    now = situation(feed(**modes, joint_flags=flags), ["a", "b"])
    assert now.detail.index("support it") < now.detail.index("idle (releases all drives), hold")
    assert ("acknowledge, idle" in now.detail) is (mode == "FAULT")
    for situated, disabled in ((whole, mode == "FAULT"), (now, True)):
        box = card(Shown(situated, control=True))[0]
        assert ('data-limber="hold" disabled' in box) is disabled
