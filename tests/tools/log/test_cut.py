"""A part of a log is a log: the same bytes, no others."""

import io

import pytest
from made_logs import event_bytes, records
from rich.console import Console

from limber.errors import InputError
from limber.log.cut import Part, cut
from limber.log.reader import Log

COUNT = 100


@pytest.fixture
def events():
    """A state and a torque each 10 ms, from 5 s on."""
    made = []
    for i in range(COUNT):
        state = records("joint_state_t", COUNT)[i].tobytes()
        made.append(event_bytes("JOINT_STATE", state, 2 * i, 5_000_000 + 10_000 * i))
        made.append(event_bytes("JOINT_TORQUE", b"abc", 2 * i + 1, 5_000_000 + 10_000 * i))
    return made


@pytest.fixture
def path(tmp_path, events):
    (tmp_path / "run.lcmlog").write_bytes(b"".join(events))
    return tmp_path / "run.lcmlog"


def cut_to(path, name, *part):
    cut(path, path.with_name(name), Part(*part), Console(file=io.StringIO()))
    return path.with_name(name)


@pytest.mark.parametrize("name", ["part.lcmlog", "part.lcmlog.zst"])
def test_a_range_of_time(path, events, name):
    made = cut_to(path, name, 0.2, 0.5)
    whole = cut_to(made, "again.lcmlog")
    assert whole.read_bytes() == b"".join(events[40:102])
    assert (made.read_bytes() == whole.read_bytes()) == (name == "part.lcmlog")


def test_some_channels(path, events):
    made = cut_to(path, "part.lcmlog", 0.0, float("inf"), ("JOINT_TORQUE",))
    assert made.read_bytes() == b"".join(events[1::2])


def test_of_a_damaged_log_the_whole_events(path, events):
    events[50] = events[50][:200] + b"x" + events[50][200:]
    path.write_bytes(b"".join(events)[:-1])
    made = cut_to(path, "part.lcmlog")
    assert made.read_bytes() == b"".join([*events[:50], *events[51:-1]])
    assert Log(made).damage() == ""


def test_nothing_there(path):
    before = sorted(path.parent.iterdir())
    with pytest.raises(InputError, match="no message in this part"):
        cut_to(path, "part.lcmlog", 0.201, 0.202)
    with pytest.raises(InputError, match=r"ends after 0\.99 s"):
        cut_to(path, "part.lcmlog", 1.0)
    assert sorted(path.parent.iterdir()) == before
