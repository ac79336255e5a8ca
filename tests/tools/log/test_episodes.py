"""Episodes of a log: from marks in every order, doubled and garbled, and dropped afterwards."""

import io

import pytest
import zstandard
from made_logs import event_bytes, records
from rich.console import Console

from limber.errors import InputError
from limber.log import episodes
from limber.log.reader import Log
from limber.messages import message_class

MARK = message_class("episode_mark_t")
START, SUCCESS, FAILURE = MARK.MARK_START, MARK.MARK_SUCCESS, MARK.MARK_FAILURE
DROP, KEEP = MARK.MARK_DROP, MARK.MARK_KEEP
LENGTH_s = 20


def mark(seq, kind, task="", episode=0):
    message = MARK()
    message.seq, message.mark, message.task, message.episode = seq, kind, task, episode
    return message.encode()


def log_of(path, *marks):
    """A state a second, and at the seconds named what is named."""
    states = records("joint_state_t", LENGTH_s)
    events = [(second, "JOINT_STATE", state.tobytes()) for second, state in enumerate(states)]
    events += [(second, "EPISODE", data) for second, data in marks]
    events.sort(key=lambda event: event[0])
    plain = b"".join(
        event_bytes(channel, data, i, 1_000_000 * second)
        for i, (second, channel, data) in enumerate(events)
    )
    path.write_bytes(zstandard.compress(plain) if path.suffix == ".zst" else plain)
    return path


def found(path):
    """Number, start and end in s, task, outcome, dropped."""
    return [
        (e.number, e.start_us / 1e6, e.end_us / 1e6, e.task, e.outcome, e.dropped)
        for e in episodes.episodes(Log(path))
    ]


def test_start_end_task_and_outcome(tmp_path):
    path = log_of(
        tmp_path / "a.lcmlog",
        (2, mark(20, START, "pick")),
        (5, mark(50, SUCCESS)),
        (6, mark(60, START, "place")),
        (9, mark(90, FAILURE)),
        (10, mark(100, DROP)),
        (12, mark(120, START)),
        (14, mark(140, START)),  # ends the one before
    )
    assert found(path) == [
        (1, 2, 5, "pick", "success", False),
        (2, 6, 9, "place", "failure", True),
        (3, 12, 14, "", "", False),
        (4, 14, 19, "", "", False),
    ]
    used, told = episodes.usable(episodes.episodes(Log(path)))
    assert [one.number for one in used] == [1]
    assert told == [
        "episode 2 is left out: dropped",
        "episode 3 is left out: it has no end",
        "episode 4 is left out: it has no end",
    ]


def test_a_mark_that_came_twice_counts_once(tmp_path):
    """It was sent again, since its confirmation was lost."""
    path = log_of(
        tmp_path / "a.lcmlog",
        (1, mark(10, START, "pick")),
        (2, mark(10, START, "pick")),
        (3, mark(30, SUCCESS)),
        (4, mark(40, START, "place")),
        (5, mark(30, SUCCESS)),
        (6, mark(60, FAILURE)),
    )
    assert found(path) == [
        (1, 1, 3, "pick", "success", False),
        (2, 4, 6, "place", "failure", False),
    ]


def test_a_task_cannot_command_a_terminal(tmp_path):
    path = log_of(tmp_path / "a.lcmlog", (1, mark(1, START, "\x1b[2J\n[red]x")))
    assert found(path)[0][3] == "?[2J?[red]x"
    with Console(file=io.StringIO()) as console:
        episodes.show(path, console)
    assert "?[2J?[red]x" in console.file.getvalue()


def test_an_end_may_be_corrected_and_stays_where_it_was(tmp_path):
    path = log_of(
        tmp_path / "a.lcmlog", (1, mark(1, START)), (3, mark(2, SUCCESS)), (9, mark(3, FAILURE))
    )
    assert found(path) == [(1, 1, 3, "", "failure", False)]


def test_what_is_no_mark_changes_nothing(tmp_path):
    good = mark(10, START, "pick")
    path = log_of(
        tmp_path / "a.lcmlog",
        (1, mark(5, SUCCESS)),  # of none
        (2, good),
        (3, good[:-4]),
        (3, b"\0" * 40),
        (3, mark(31, 5)),
        (3, mark(32, -1)),
        (3, mark(0, START)),
        (3, mark(33, START, "x" * 201)),
        (3, mark(34, DROP, episode=77)),
        (8, mark(80, SUCCESS)),
    )
    assert found(path) == [(1, 2, 8, "pick", "success", False)]


@pytest.mark.parametrize("name", ["a.lcmlog", "a.lcmlog.zst"])
def test_dropped_afterwards_and_taken_back(tmp_path, name):
    marks = [
        (1, mark(10, START)),
        (3, mark(30, SUCCESS)),
        (4, mark(40, START)),
        (6, mark(60, SUCCESS)),
    ]
    path = log_of(tmp_path / name, *marks)
    before = path.read_bytes()
    states = Log(path).read("JOINT_STATE").tobytes()
    episodes.mark(path, [1], [])
    assert [row[-1] for row in found(path)] == [True, False]
    episodes.mark(path, [2], [1])
    assert [row[-1] for row in found(path)] == [False, True]
    assert [row[1:3] for row in found(path)] == [(1, 3), (4, 6)]
    assert path.read_bytes().startswith(before)
    log = Log(path)
    assert log.damage() == "" and log.read("JOINT_STATE").tobytes() == states
    with pytest.raises(InputError, match="episode 3: this log has 2"):
        episodes.mark(path, [3], [])


def test_a_log_that_is_cut_off_is_not_added_to(tmp_path):
    """What is added would make the last bytes unreadable."""
    path = log_of(tmp_path / "a.lcmlog", (1, mark(10, START)))
    path.write_bytes(path.read_bytes()[:-5])
    before = path.read_bytes()
    with pytest.raises(InputError, match="limber log cut"):
        episodes.mark(path, [1], [])
    assert path.read_bytes() == before


def test_a_log_that_is_written_is_not_added_to(tmp_path):
    path = log_of(tmp_path / "a.lcmlog", (1, mark(10, START)))
    with open(path, "ab"), pytest.raises(InputError, match="is being recorded"):
        episodes.mark(path, [1], [])
    episodes.mark(path, [1], [])


def test_episodes_of_a_run(tmp_path):
    """A drop behind the last run counts in the first one, too."""
    path = tmp_path / "two.lcmlog"
    first = log_of(tmp_path / "a.lcmlog", (1, mark(10, START, "one")), (3, mark(30, SUCCESS)))
    second = log_of(tmp_path / "b.lcmlog", (2, mark(40, START, "two")), (3, mark(60, FAILURE)))
    path.write_bytes(first.read_bytes() + second.read_bytes())
    episodes.mark(path, [1], [])
    log = Log(path)
    whole = episodes.episodes(log)
    assert [(one.task, one.dropped) for one in whole] == [("one", True), ("two", False)]
