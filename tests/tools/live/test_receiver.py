"""What is counted and kept of a channel; the wire is in tests/system/test_receiver.py."""

import threading

import numpy as np
import pytest
from made_logs import records

from limber import messages
from limber.live.receiver import ChannelState, Stream


def feed(state: ChannelState, rows: np.ndarray) -> None:
    for row in rows:
        state.take(row.tobytes())


def numbered(sequence: list[int], session: int = 1) -> np.ndarray:
    return records("joint_state_t", len(sequence), seq=sequence, session=session)


def test_losses_are_gaps_of_each_sender():
    state = ChannelState("joint_state_t")
    feed(state, numbered([7, 8, 11]))
    assert (state.count, state.lost) == (3, 2)
    feed(state, numbered([0, 1], session=2))  # the driver was started again
    assert state.lost == 2
    feed(state, numbered([3], session=2))
    assert state.lost == 3
    feed(state, numbered([12], session=1))  # a late one of the old driver is none
    assert state.lost == 3


def test_two_senders_that_take_turns_lose_nothing():
    state = ChannelState("controller_status_t")
    both = records("controller_status_t", 6, seq=[5, 90, 6, 91, 7, 92])
    both["controller"] = [1, 2, 1, 2, 1, 2]
    feed(state, both)
    assert (state.count, state.lost) == (6, 0)


def test_a_number_that_goes_back_is_no_loss():
    state = ChannelState("sim_truth_t")  # names no sender
    feed(state, records("sim_truth_t", 3, seq=[100, 101, 0]))
    assert state.lost == 0


def test_cycles_without_an_answer_are_no_losses():
    state = ChannelState("joint_command_t")
    feed(state, records("joint_command_t", 3, state_seq=[1, 2, 9]))
    assert (state.count, state.lost) == (3, 0)


def test_other_types_are_counted_and_left_out():
    state = ChannelState("joint_state_t")
    stream = Stream(state, threading.Condition())
    feed(state, numbered([1]))
    state.take(numbered([2]).tobytes()[:-1])
    state.take(bytes(len(state.data)))
    feed(state, records("joint_command_t", 1))
    assert (state.count, state.undecodable, state.lost) == (1, 3, 0)
    assert list(stream.read()["seq"]) == [1]


def test_a_stream_gives_every_message_once():
    state = ChannelState("joint_state_t")
    feed(state, numbered([1, 2]))
    stream = Stream(state, threading.Condition())
    feed(state, numbered([3, 4]))
    batch = stream.read()
    assert list(batch["seq"]) == [3, 4], "from its opening on"
    assert batch["q"].dtype.isnative and batch["q"].shape == (2, 16)
    assert len(stream.read()) == 0
    feed(state, numbered([5]))
    stream.close()
    feed(state, numbered([6]))
    assert list(stream.read()["seq"]) == [5]


def test_types_with_strings_are_kept_as_bytes():
    state = ChannelState("request_answer_t", numbered=False)
    stream = Stream(state, threading.Condition())
    answer = messages.message_class("request_answer_t")()
    answer.reason = "because"
    state.take(answer.encode())
    with pytest.raises(ValueError, match="no fixed size"):
        stream.read()
    for data in (b"", answer.encode()[:7], bytes(40)):
        state.take(data)
    state.take(answer.encode())
    assert (state.count, state.undecodable) == (2, 3)
    assert messages.decode("request_answer_t", stream.raw()[0]).reason == "because"
