"""What became of requests, and gains that wait for ACTIVE."""

import threading

import numpy as np
import pytest

from limber import messages
from limber.live.gains_message import gains
from limber.messages import message_class
from limber.monitor.answers import Answers
from limber.monitor.feed import Batch
from limber.monitor.page_link import PageLink
from limber.monitor.pending import MOST_LINES, UNSEEN, Pending, several
from limber.monitor.typed import Field, TypedFields
from limber.monitor.viewers import RAIL_PX, note, widths

STATUS, ANSWER = message_class("controller_status_t"), message_class("request_answer_t")


def status(mode: int, K: float = 300.0, controller: int = 7) -> np.void:
    made = np.zeros(1, messages.native_dtype_of("controller_status_t"))[0]
    made["mode"], made["controller"], made["num_joints"] = mode, controller, 7
    made["K_x"], made["K_q"] = np.diag([K] * 3 + [15.0] * 3), 60.0
    return made


def taken(message, accepted: bool = True, client: int = 5, seen: bool = True) -> Batch:
    message.client, message.seq = client, 1000
    answer = ANSWER()
    answer.client, answer.seq, answer.kind = client, 1000, ANSWER.KIND_GAINS
    answer.accepted = int(accepted)
    found = {"REQUEST_ANSWER": [answer]}
    return Batch(objects={**found, **({"COMPLIANCE_GAINS": [message]} if seen else {})})


def test_answers_have_a_time_and_go_at_the_next_mode():
    answers = Answers()
    answers.note("gains", "refused", False, "HOLD")
    (shown,) = answers.shown("HOLD")
    assert shown.what[:8].replace(":", "").isdigit() and shown.what.endswith("gains: refused")
    assert answers.shown("ACTIVE") == []
    assert answers.shown("HOLD") == [], "it does not come back"


def test_a_stop_is_told_until_the_arm_moves_on():
    answers = Answers()
    answers.note("STOP", "taken", True, "ACTIVE")
    for mode in ("ACTIVE", "SOFT_STOP", "SOFT_STOP", "HOLD", "HOLD"):
        assert len(answers.shown(mode)) == 1, mode
    assert answers.shown("ACTIVE") == [], "the next motion is another one"
    answers.note("STOP", "taken", True, "HOLD")
    assert answers.shown("FAULT") == []


def test_what_a_fault_was_sent_is_shown_until_it_acts():
    pending = Pending()
    message = gains(7, None, 0.1, K_x_translation_N_per_m=900, damping_ratio=0.9)
    pending.note(taken(message), status(STATUS.MODE_FAULT))
    assert pending.words(status(STATUS.MODE_FAULT), "x") == [
        "K_x_translation_N_per_m: 900 (now 300)",
        "damping_ratio: 0.9",
    ]
    pending.note(Batch(), status(STATUS.MODE_HOLD))
    assert len(pending.words(status(STATUS.MODE_HOLD), "x")) == 2
    pending.note(Batch(), status(STATUS.MODE_ACTIVE))
    assert pending.words(status(STATUS.MODE_ACTIVE), "x") == []


def test_what_was_refused_or_is_of_another_run_is_not_to_come():
    pending = Pending()
    message = gains(7, "joint_pd", 0.1, K_x_translation_N_per_m=900)
    pending.note(taken(message, accepted=False), status(STATUS.MODE_FAULT))
    assert pending.words(status(STATUS.MODE_FAULT), "x") == []
    pending.note(taken(message), status(STATUS.MODE_FAULT))
    assert "law: joint_pd (now x)" in pending.words(status(STATUS.MODE_FAULT), "x")
    again = status(STATUS.MODE_IDLE, controller=8)
    pending.note(Batch(), again)
    assert pending.words(again, "x") == []


def test_gains_of_before_the_page_are_at_least_told():
    pending = Pending()
    pending.note(Batch(), status(STATUS.MODE_FAULT))
    pending.note(taken(gains(7, None, 0.1), seen=False), status(STATUS.MODE_FAULT))
    assert pending.words(status(STATUS.MODE_FAULT), "x") == [UNSEEN]


def test_many_gains_do_not_push_the_buttons_away():
    pending = Pending()
    keys = {"D_null_Nms_per_rad": 1, "damping_ratio": 0.9, "joint_damping_ratio": 0.8}
    keys |= {"friction_share": 0.5, "tank_J": 1.0, "spring_force_N": 20.0}
    pending.note(taken(gains(7, None, 0.1, **keys)), status(STATUS.MODE_FAULT))
    words = pending.words(status(STATUS.MODE_FAULT), "x")
    assert len(words) == MOST_LINES and words[-1] == "and 3 more"


def test_several_numbers_in_one_line():
    assert several([333.0, 222.0, 111.0]) == "333 / 222 / 111"
    assert several([300.0] * 3) == "300"


@pytest.fixture
def fields(served):
    told, sent = [], []
    link = PageLink(threading.RLock())
    typed = TypedFields(link, lambda *words: told.append(words))
    slider = served.gui.add_slider("K", 0.0, 100.0, 0.5, 50.0)
    slider.precision = 3
    typed.add(Field(slider, "K", 0.0, 1000.0, sent.append))

    def type_in(text: str, slider_id: str = slider._impl.uuid) -> None:
        link._take(
            f'{{"viewer": 0, "kind": "typed", "value": {{"slider": "{slider_id}", '
            f'"text": "{text}"}}}}',
            set(),
        )

    return type_in, told, sent


@pytest.mark.parametrize(
    "text", ["-5", "1001", "1e9", "nan", "inf", "0x10", "3,5", "", "1e", "--1"]
)
def test_what_cannot_be_is_refused_in_words(fields, text):
    type_in, told, sent = fields
    type_in(text)
    assert sent == []
    ((name, words, good),) = told
    assert name == "K" and "nothing was sent" in words and not good


@pytest.mark.parametrize(
    ("text", "value", "words"),
    [
        ("0", 0.0, ""),
        (" 12.5 ", 12.5, ""),
        ("1e2", 100.0, ""),
        ("999", 999.0, ""),
        ("12.34567", 12.346, "12.34567 was rounded to 12.346"),
    ],
)
def test_what_is_typed_is_sent(fields, text, value, words):
    type_in, told, sent = fields
    type_in(text)
    assert sent == [value]
    assert [w for _, w, _ in told] == ([words] if words else [])


def test_a_field_that_is_none_takes_nothing(fields):
    type_in, told, sent = fields
    type_in("5", "another")
    assert (told, sent) == ([], [])


@pytest.mark.parametrize("window", [700, 800, 1100, 1280, 1366, 1440, 1600, 1920, 2560])
def test_the_arm_keeps_half_of_the_window(window):
    control, charts, folded = widths(window)
    assert window - control - (RAIL_PX if folded else charts) >= window // 2
    assert control >= 300


def test_charts_are_folded_where_they_would_be_slivers():
    assert widths(1100)[2] and not widths(1600)[2]
    assert widths(1600)[:2] == (350, 430)


def test_the_note_is_one_line():
    assert "nowrap" in note(3, True) and 'data-limber-viewer="3"' in note(3, True)
