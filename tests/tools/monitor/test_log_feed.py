"""A recorded run as a feed that can be moved through."""

import numpy as np
import pytest
from made_logs import event_bytes, records, write_log

from limber.errors import InputError
from limber.log.reader import Log
from limber.messages import message_class
from limber.monitor.log_feed import LogFeed

MS = 10**6


@pytest.fixture
def feed(tmp_path):
    state = records("joint_state_t", 1000, time_ns=np.arange(1000) * 10 * MS, num_joints=1)
    state["q"][:, 0] = np.arange(1000)
    status = records("controller_status_t", 100, time_ns=np.arange(100) * 50 * MS)  # ends at 5 s
    return LogFeed(
        Log(write_log(tmp_path / "log", {"JOINT_STATE": state, "CONTROLLER_STATUS": status})), 2.0
    )


def test_playing_gives_every_message_once(feed):
    feed.playing = True
    seen = [feed.take().read("JOINT_STATE")["q"][:, 0]]
    for _ in range(400):
        feed.advance(0.033)
        seen.append(feed.take().read("JOINT_STATE")["q"][:, 0])
    assert np.concatenate(seen).tolist() == list(range(1000))
    assert not feed.playing, "stops at the end"


def test_speed_and_pause(feed):
    feed.advance(1.0)
    assert feed.position_s == 0.0, "paused at the beginning"
    feed.playing, feed.speed = True, 2.0
    feed.advance(1.0)
    assert feed.position_s == 2.0
    feed.playing = False
    feed.advance(1.0)
    assert feed.position_s == 2.0
    feed.take()
    assert len(feed.take().read("JOINT_STATE")) == 0


def test_a_jump_gives_the_history_of_the_charts(feed):
    feed.take()
    feed.jump(6.0)
    batch = feed.take()
    assert batch.restart
    q = batch.read("JOINT_STATE")["q"][:, 0]
    assert (q[0], q[-1]) == (401, 600)
    assert feed.newest["JOINT_STATE"]["q"][0] == 600
    feed.jump(-5.0)
    feed.take()
    assert feed.position_s == 0.0, "no further than the log"
    feed.jump(1e9)
    assert feed.position_s == 9.99


def test_a_process_that_had_died_shows_as_dead(feed):
    feed.jump(4.0)
    feed.take()
    assert feed.age_s("CONTROLLER_STATUS") < 0.06
    feed.jump(8.0)
    feed.take()
    assert np.isclose(feed.age_s("CONTROLLER_STATUS"), 8.0 - 4.95)
    assert feed.age_s("SIM_TRUTH") == np.inf


def test_answers_up_to_the_place_only(tmp_path):
    state = records("joint_state_t", 100, time_ns=np.arange(100) * 100 * MS)
    path = write_log(tmp_path / "log", {"JOINT_STATE": state})
    with open(path, "ab") as file:
        for seconds in (2, 7):
            answer = message_class("request_answer_t")()
            answer.time_ns = seconds * 1000 * MS
            file.write(event_bytes("REQUEST_ANSWER", answer.encode()))
    feed = LogFeed(Log(path), 60.0)
    feed.jump(5.0)
    assert [a.time_ns for a in feed.take().objects["REQUEST_ANSWER"]] == [2000 * MS]


def test_of_several_sessions_the_longest_is_shown(tmp_path):
    state = records("joint_state_t", 300, session=1, time_ns=np.arange(300) * 10 * MS)
    state["session"][:100], state["time_ns"][:100] = 2, np.arange(100) * 10 * MS + 10**12
    feed = LogFeed(Log(write_log(tmp_path / "log", {"JOINT_STATE": state})), 2.0)
    assert (feed.start_s, feed.end_s) == (1.0, 2.99)
    assert any("2 sessions" in line for line in feed.troubles())


def test_a_log_without_an_arm(tmp_path):
    status = records("controller_status_t", 10)
    with pytest.raises(InputError, match="no JOINT_STATE"):
        LogFeed(Log(write_log(tmp_path / "log", {"CONTROLLER_STATUS": status})), 2.0)
