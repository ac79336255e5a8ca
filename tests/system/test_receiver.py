"""The Python receiver on the wire: every message, whatever the script does meanwhile."""

import ctypes
import sys
import time
from contextlib import closing

import numpy as np
import pytest
from processes import started

import numbered_messages
from limber import messages
from limber.live.receiver import Receiver
from numbered_messages import CHANNELS


@pytest.fixture
def publisher():
    with started([sys.executable, numbered_messages.__file__]) as process:
        yield process
        process.terminate()


def hold_python(seconds: float) -> None:
    """Like a library that computes without giving other threads a turn."""
    ctypes.PyDLL(None).usleep(int(1e6 * seconds))


def test_nothing_is_lost_while_the_script_is_busy(publisher):
    with closing(Receiver(*CHANNELS)) as receiver:
        states = receiver.channels.values()
        assert receiver.wait_for(lambda: all(state.count for state in states), 20)
        streams = [receiver.stream(name) for name in CHANNELS]
        for _ in range(3):
            hold_python(0.3)
            time.sleep(0.1)
        for stream in streams:
            batch = stream.read()
            seq = batch[batch.dtype.names[1]]
            assert len(seq) > 1000
            np.testing.assert_array_equal(np.diff(seq), 1)
        assert [state.lost for state in states] == [0] * len(CHANNELS)


def test_who_waits_wakes_up(publisher):
    with closing(Receiver("JOINT_STATE", interval_s=0.002)) as receiver:
        stream = receiver.stream("JOINT_STATE")
        assert stream.wait(20)
        assert len(stream.read()) > 0
        publisher.terminate()
        publisher.wait()
        time.sleep(0.2)
        stream.read()
        assert not stream.wait(0.1)


def test_a_gap_on_the_wire_is_counted():
    with closing(Receiver("SIM_TRUTH")) as receiver:
        truth = messages.message_class("sim_truth_t")()
        for truth.seq in (1, 2, 6):
            receiver.publish("SIM_TRUTH", truth)
        state = receiver.channels["SIM_TRUTH"]
        assert receiver.wait_for(lambda: state.count == 3, 10)
        assert state.lost == 3
