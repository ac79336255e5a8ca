"""Children end together, whatever happens; one that dies is named with its last words."""

import os
import signal
import time
from contextlib import contextmanager
from io import StringIO

import pytest
from rich.console import Console

from limber.errors import InputError, RunError
from limber.run.options import FinishedRun, RunOptions
from limber.run.processes import ProcessGroup, process_group
from limber.run.runner import _follow

FOREVER = ["sleep", "1000"]
STUBBORN = ["sh", "-c", "trap '' TERM; echo ready; while :; do sleep 0.05; done"]


def alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def test_nothing_is_left_after_an_error(tmp_path):
    with pytest.raises(ValueError, match="in between"), process_group(tmp_path) as group:
        pids = [group.start(name, FOREVER).process.pid for name in ("one", "two")]
        assert all(os.getpgid(pid) == pids[0] for pid in pids), "one process group"
        raise ValueError("in between")
    assert not any(alive(pid) for pid in pids)


def test_stubborn_child_is_killed(tmp_path):
    with process_group(tmp_path) as group:
        child = group.start("stubborn", STUBBORN)
        group.wait_for_line(child, "ready", 5)
        assert group.stop("stubborn", signal.SIGTERM, 0.2) == -signal.SIGKILL
    assert not alive(child.process.pid)


def test_child_dies_with_its_parent(tmp_path):
    """Even SIGKILL for limber itself leaves no process behind."""
    reader, writer = os.pipe()
    parent = os.fork()
    if parent == 0:
        group = ProcessGroup(tmp_path)
        os.write(writer, b"%d" % group.start("child", FOREVER).process.pid)
        time.sleep(100)
    child = int(os.read(reader, 20))
    os.kill(parent, signal.SIGKILL)
    os.waitpid(parent, 0)
    deadline = time.monotonic() + 5
    while alive(child) and time.monotonic() < deadline:
        time.sleep(0.01)
    assert not alive(child)


def test_death_is_reported_with_last_words(tmp_path):
    with process_group(tmp_path) as group, pytest.raises(RunError) as caught:
        group.start("sleeper", FOREVER)
        group.start("talker", ["sh", "-c", "echo one; echo two >&2; exit 3"])
        group.run_until("sleeper", lambda: None)
    said = str(caught.value)
    assert "talker ended (exit code 3)" in said
    assert "two" in said and "talker.log" in said


def test_wrong_set_up_is_the_users_input(tmp_path):
    with process_group(tmp_path) as group, pytest.raises(InputError, match=r"^a key is wrong$"):
        child = group.start("tool", ["sh", "-c", "echo 'tool: a key is wrong' >&2; exit 2"])
        group.wait_for_line(child, "never said", 5)


def test_signal_is_named(tmp_path):
    with process_group(tmp_path) as group, pytest.raises(RunError, match="killed by SIGSEGV"):
        group.start("crasher", ["sh", "-c", "kill -SEGV $$"])
        group.start("sleeper", FOREVER)
        group.run_until("sleeper", lambda: None)


def test_run_until_returns_the_code_and_ticks(tmp_path):
    ticks = []
    with process_group(tmp_path) as group:
        group.start("sleeper", FOREVER)
        group.start("short", ["sh", "-c", "sleep 0.2; exit 7"])
        assert group.run_until("short", lambda: ticks.append(1), 0.01) == 7
    assert len(ticks) > 3


def test_news_are_warnings_and_errors_each_told_once(tmp_path):
    says = (
        "echo '10:00 x: up'; echo '10:00 x: warning: no watchdog'; printf '10:01 x: error: regis';"
        "sleep 0.5; echo 'ter 21 is 12.566'; sleep 1000"
    )
    with process_group(tmp_path) as group:
        child = group.start("x", ["sh", "-c", says])
        group.wait_for_line(child, "regis", 5)
        assert child.news() == ["no watchdog"]
        group.wait_for_line(child, "12.566\n", 5)
        assert child.news() == ["register 21 is 12.566"]
        assert child.news() == []


def test_news_of_the_driver_reach_the_terminal_while_it_runs(tmp_path):
    shown = StringIO()
    says = "echo '10:00 x: error: register 21 is 12.566'; sleep 0.5"
    seen = []
    with process_group(tmp_path) as group:
        child = group.start("limber-driver", ["sh", "-c", says])

        @contextmanager
        def display():
            yield lambda: seen.append((child.code, shown.getvalue()))

        run = FinishedRun(tmp_path, "realtime")
        _follow(group, child.name, display(), run, RunOptions(), Console(file=shown))
    assert (None, "register 21 is 12.566\n") in seen
