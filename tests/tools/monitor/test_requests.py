"""What the page sends, and what it makes of the answers."""

import time

import numpy as np
import pytest
from rich.console import Console

from limber import messages
from limber.messages import message_class
from limber.monitor.feed import Batch
from limber.monitor.guard import Guard
from limber.monitor.requests import STOP_TRIES, Requests

MODE, ANSWER = message_class("mode_request_t"), message_class("request_answer_t")
CLIENT = 4711


class Feed:
    """Keeps what is published."""

    def __init__(self) -> None:
        self.sent = []
        status = np.zeros(1, messages.native_dtype_of("controller_status_t"))[0]
        status["controller"], status["num_joints"] = 99, 7
        self.newest = {"CONTROLLER_STATUS": status}
        self.receiver = self

    def publish(self, channel, message):
        type_name = messages.channels()[channel].type_name
        self.sent.append((channel, messages.decode(type_name, message.encode())))


@pytest.fixture
def feed():
    return Feed()


@pytest.fixture
def requests(feed):
    return Requests(feed, CLIENT)


def answer(message, kind, what=0, code=0, client=CLIENT) -> Batch:
    made = ANSWER()
    made.client, made.seq, made.kind, made.what = client, message.seq, kind, what
    made.accepted, made.code, made.reason = int(code == 0), code, "x is 3"
    return Batch(objects={"REQUEST_ANSWER": [made]})


def test_requests_carry_run_lease_and_a_rising_number(feed, requests):
    requests.mode("hold")
    requests.goal(np.array([0.1, 0.2, 0.3]), np.array([1.0, 0, 0, 0]))
    requests.gains({"K_x_translation_N_per_m": [1.0, 2.0, 3.0], "law": "joint_pd"}, 0.2)
    (_, mode), (_, goal), (_, gains) = feed.sent
    assert mode.request == MODE.REQUEST_HOLD
    assert (goal.kind, goal.p_BD, goal.duration_s) == (goal.GOAL_POSE, (0.1, 0.2, 0.3), 0.0)
    assert gains.named == ["K_x_translation_N_per_m"] and gains.law == "joint_pd"
    for message in (mode, goal, gains):
        assert (message.client, message.controller) == (CLIENT, 99)
    assert mode.seq < goal.seq < gains.seq


def test_refusals_come_back_in_words_with_what_to_do(feed, requests):
    requests.goal(np.zeros(3), np.array([1.0, 0, 0, 0]))
    (outcome,) = requests.collect(
        answer(feed.sent[-1][1], ANSWER.KIND_GOAL, code=ANSWER.REFUSED_LEASE)
    )
    assert outcome.kind == "goal"
    assert outcome.text.startswith("request.LEASE: x is 3")
    assert "release" in outcome.text


def test_what_nobody_answers_is_told(requests):
    requests.mode("hold")
    assert requests.collect(Batch()) == []
    time.sleep(0.6)
    (outcome,) = requests.collect(Batch())
    assert (outcome.kind, outcome.text) == ("mode", "no controller answers")


def test_answers_to_others_are_theirs(feed, requests):
    requests.mode("hold")
    assert requests.collect(answer(feed.sent[-1][1], ANSWER.KIND_MODE, client=5)) == []


def test_gains_that_cannot_be_are_not_sent(feed, requests):
    requests.gains({"damping_ratio": float("nan")}, 0.2)
    requests.gains({"law": "no_such_law"}, 0.2)
    assert feed.sent == []
    assert [outcome.kind for outcome in requests.collect(Batch())] == ["gains", "gains"]


def test_a_stop_is_repeated_until_it_is_answered(feed, requests):
    requests.stop()
    for _ in range(3):
        time.sleep(0.05)
        requests.collect(Batch())
    assert len(feed.sent) == 4
    assert all(message.request == MODE.REQUEST_STOP for _, message in feed.sent)
    requests.collect(answer(feed.sent[1][1], ANSWER.KIND_MODE, MODE.REQUEST_STOP))
    assert requests.stop_state == "taken by the controller"
    time.sleep(0.05)
    requests.collect(Batch())
    assert len(feed.sent) == 4


def test_a_stop_that_nobody_answers_is_not_confirmed(feed, requests):
    requests.stop()
    for _ in range(STOP_TRIES + 2):
        time.sleep(0.045)
        requests.collect(Batch())
    assert len(feed.sent) == STOP_TRIES
    assert "NOT CONFIRMED" in requests.stop_state


def test_the_lease_is_given_back_only_by_who_has_it(feed, requests):
    requests.close()
    assert feed.sent == []
    requests.mode("hold")
    requests.collect(answer(feed.sent[-1][1], ANSWER.KIND_MODE, MODE.REQUEST_HOLD))
    requests.close()
    assert feed.sent[-1][1].request == MODE.REQUEST_RELEASE


def test_a_part_that_fails_stops_no_other(capsys):
    guard = Guard(Console())
    done = []
    for _ in range(3):
        guard(lambda: 1 / 0)
        guard(done.append, 1)
    assert done == [1, 1, 1]
    assert guard.faults == ["ZeroDivisionError: division by zero"]
    assert capsys.readouterr().out.count("Traceback") == 1
