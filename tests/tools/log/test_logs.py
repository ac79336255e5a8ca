"""Whole logs are read whole; damaged ones as far as they are good, and the reader says so."""

import lcm
import numpy as np
import pytest
from made_logs import event_bytes, records, write_log

from limber import messages
from limber.errors import InputError
from limber.log.reader import Log, count_gaps

COUNT = 50
EVENT_SIZE = 28 + len("JOINT_STATE") + messages.dtype_of("joint_state_t").itemsize


@pytest.fixture
def states():
    made = records("joint_state_t", COUNT)
    made["time_ns"] = made["seq"] * 1_000_000
    made["q"][:, 0] = np.sin(np.arange(COUNT))
    return made


@pytest.fixture
def path(tmp_path, states):
    return write_log(tmp_path / "run.lcmlog", {"JOINT_STATE": states})


def test_reads_what_was_written(path, states):
    read = Log(path).read("JOINT_STATE")
    assert len(read) == COUNT
    np.testing.assert_array_equal(read["q"], states["q"])
    assert read["q"].dtype.isnative
    assert Log(path).damage() == ""


def test_agrees_with_lcms_own_reader_and_writer(tmp_path, states):
    theirs = lcm.EventLog(str(tmp_path / "log"), "w")
    for i, state in enumerate(states):
        theirs.write_event(i * 1000, "JOINT_STATE", state.tobytes())
    theirs.close()
    again = lcm.EventLog(str(tmp_path / "log"))
    ours = Log(tmp_path / "log")
    assert ours.raw("JOINT_STATE") == [e.data for e in again]
    assert ours.channels["JOINT_STATE"].stamps_us[7] == 7000


def test_folder_of_a_run_stands_for_its_log(path):
    assert len(Log(path.parent).read("JOINT_STATE")) == COUNT


@pytest.mark.parametrize("cut", [1, 20, EVENT_SIZE - 1])
def test_truncated_tail(path, cut):
    data = path.read_bytes()
    path.write_bytes(data[:-cut])
    log = Log(path)
    assert len(log.read("JOINT_STATE")) == COUNT - 1
    assert log.truncated_bytes == EVENT_SIZE - cut
    assert log.skipped_bytes == 0
    assert "cut off" in log.damage()


def test_garbage_inside_an_event_costs_that_event_only(path):
    data = path.read_bytes()
    at = 20 * EVENT_SIZE + 300
    path.write_bytes(data[:at] + b"\x55" * 333 + data[at:])
    log = Log(path)
    kept = log.read("JOINT_STATE")["seq"]
    np.testing.assert_array_equal(kept, np.delete(np.arange(COUNT), 20))
    assert log.skipped_bytes == EVENT_SIZE + 333
    assert log.lost("JOINT_STATE") == 1


def test_missing_bytes_cost_one_event_only(path):
    data = path.read_bytes()
    at = 20 * EVENT_SIZE + 300
    path.write_bytes(data[:at] + data[at + 10 :])
    kept = Log(path).read("JOINT_STATE")["seq"]
    np.testing.assert_array_equal(kept, np.delete(np.arange(COUNT), 20))


def test_overwritten_header_costs_one_event_only(path):
    data = bytearray(path.read_bytes())
    data[20 * EVENT_SIZE + 24 : 20 * EVENT_SIZE + 28] = b"\x7f\xff\xff\xff"  # an absurd length
    path.write_bytes(data)
    log = Log(path)
    # its neighbour before it ends where a sync word still stands, so only the event itself is lost
    np.testing.assert_array_equal(log.read("JOINT_STATE")["seq"], np.delete(np.arange(COUNT), 20))
    assert log.skipped_bytes == EVENT_SIZE


def test_sync_word_in_the_data_does_not_confuse(tmp_path, states):
    states["session"][10] = int.from_bytes(b"\xed\xa1\xda\x01\xed\xa1\xda\x01", "big", signed=True)
    path = write_log(tmp_path / "log", {"JOINT_STATE": states})
    data = path.read_bytes()
    at = 10 * EVENT_SIZE + 300
    path.write_bytes(data[:at] + b"\0" * 7 + data[at:])
    kept = Log(path).read("JOINT_STATE")["seq"]
    np.testing.assert_array_equal(kept, np.delete(np.arange(COUNT), 10))


def test_garbage_before_the_first_event(path):
    path.write_bytes(b"\x01\x02\x03" * 11 + path.read_bytes())
    log = Log(path)
    assert len(log.read("JOINT_STATE")) == COUNT
    assert log.skipped_bytes == 33


@pytest.mark.parametrize("content", [b"", b"no log at all, just text", b"\xed\xa1\xda\x01"])
def test_no_log(tmp_path, content):
    path = tmp_path / "x.lcmlog"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"empty|no LCM event log"):
        Log(path)


def test_missing_and_folder(tmp_path):
    with pytest.raises(InputError, match="does not exist"):
        Log(tmp_path / "none.lcmlog")
    with pytest.raises(InputError, match=r"run\.lcmlog"):
        Log(tmp_path)


def test_gaps():
    assert count_gaps(np.array([0, 1, 2, 3])) == 0
    assert count_gaps(np.array([0, 1, 5, 6, 8])) == 4
    assert count_gaps(np.array([7, 8, 0, 1])) == 0, "a new run of the sender is no loss"


def test_other_version_of_a_type_is_refused(tmp_path, states):
    states[messages.FINGERPRINT] += 1
    log = Log(write_log(tmp_path / "log", {"JOINT_STATE": states}))
    with pytest.raises(InputError, match="another version"):
        log.read("JOINT_STATE")
    assert log.undecodable("JOINT_STATE") == COUNT


def test_foreign_channels_do_not_disturb(path):
    path.write_bytes(event_bytes("SOMETHING_ELSE", b"abc") + path.read_bytes())
    log = Log(path)
    assert log.type_of("SOMETHING_ELSE") is None
    assert len(log.read("JOINT_STATE")) == COUNT
    with pytest.raises(InputError, match="SOMETHING_ELSE"):
        log.read("SOMETHING_ELSE")
