"""What the page tells about the arm's state."""

import numpy as np
import pytest

from limber.messages import message_class
from limber.monitor.feed import NEVER_S
from limber.monitor.status_card import card
from limber.monitor.words import BAD, GOOD, WARN, situation

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
    assert note.do.startswith("Check power")


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
    html = card(now, ["<b>law"], ["<i>hint"])
    assert "<script>" not in html and "<b>law" not in html and "<i>hint" not in html
    assert "&lt;script&gt;" in html
