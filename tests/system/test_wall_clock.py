"""The wall clock is set by an hour, forwards and backwards, under everything that runs: nothing
takes notice of it. The same with the kernel's own clock: tests/vcan/test_wall_clock.py.
"""

import signal
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from many_viewers import viewers
from processes import started

from browser_page import free_port
from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber.lcmtypes.joint_state_t import joint_state_t as State
from limber.lcmtypes.push_t import push_t
from limber.log.reader import Log
from stack import BIN, ROOT

HOUR_ns = 3600 * 10**9
PUSH_N, PUSH_s = 3.0, 2.0
MOST_s = 1000.0  # that the test lasts, by far; less than the step

CLIENT = """
import sys
from limber import Arm
with Arm() as arm:
    arm.activate()
    print("active", flush=True)
    for _ in sys.stdin:
        arm.wait(for_s=0.3)
        arm.soften(200)
        print("taken", flush=True)
"""


class WallClock:
    """As the processes see it that are started after it."""

    def __init__(self, folder: Path, setenv) -> None:
        library = folder / "set_wall_clock.so"
        source = Path(__file__).with_name("set_wall_clock.cc")
        command = ["c++", "-std=c++20", "-O1", "-shared", "-fPIC", "-o", library, source, "-ldl"]
        subprocess.run(command, check=True)
        self._file = folder / "step"
        self.add(0)
        setenv("LIMBER_TEST_CLOCK", str(self._file))
        setenv("LD_PRELOAD", str(library))

    def add(self, step_ns: int) -> None:
        """To the true one."""
        self._file.touch()
        with open(self._file, "r+b") as file:  # in place: it is mapped
            file.write(step_ns.to_bytes(8, sys.byteorder, signed=True))


@pytest.fixture
def wall_clock(tmp_path, monkeypatch):
    return WallClock(tmp_path, monkeypatch.setenv)


@contextmanager
def interrupted(*command, **options):
    """Ended by Ctrl-C, as a user does, if it has not ended by then."""
    with started(command, stdout=subprocess.PIPE, text=True, **options) as process:
        try:
            yield process
        finally:
            if process.poll() is None:
                process.send_signal(signal.SIGINT)


def push(stack) -> None:
    message = push_t()
    message.seq, message.id, message.link = stack.state.seq, 1, ""
    message.wrench = [PUSH_N, 0.0, 0.0, 0.0, 0.0, 0.0]
    message.duration_s = PUSH_s
    stack.user.lcm.publish("PUSH", message.encode())


def pushed_s(stack, since: int) -> list[float]:
    """Arm times at which the arm was pushed; single messages may be lost here."""
    truths = stack.user.since("SIM_TRUTH", since)
    return [1e-9 * truth.time_ns for truth in truths if truth.F_push[0] != 0.0]


def is_over(stack, since: int) -> bool:
    """The push, as all that has come is followed by a truth without it."""
    return bool(pushed_s(stack, since)) and stack.truth.F_push[0] == 0.0


def test_nothing_takes_notice(wall_clock, stack, tmp_path):
    stack.start_all()
    stack.until(lambda: stack.mode is not None, 20, "the controller answers")
    port, log = free_port(), tmp_path / "run.lcmlog.zst"
    page = sys.executable, "-m", "limber", "monitor", "--port", str(port)
    with (
        interrupted(BIN / "limber-record", "--out", log) as recorder,
        interrupted(*page, cwd=ROOT) as monitor,
        interrupted(sys.executable, "-c", CLIENT, stdin=subprocess.PIPE) as client,
    ):
        assert "http://" in monitor.stdout.readline()
        assert client.stdout.readline() == "active\n"
        begun = stack.user.count("JOINT_STATE")
        with viewers(port, 1) as looking:
            stack.until(lambda: looking.read[0] > 0, 20, "the page is seen")
            for step_ns in (HOUR_ns, -HOUR_ns, 0):
                since, read = stack.user.count("SIM_TRUTH"), looking.read[0]
                push(stack)
                stack.until(lambda at=since: pushed_s(stack, at), 10, "the push")
                wall_clock.add(step_ns)
                client.stdin.write("go on\n")
                client.stdin.flush()
                assert client.stdout.readline() == "taken\n", "the client has its lease"
                stack.until(lambda at=since: is_over(stack, at), 10, "the end of the push")
                assert np.ptp(pushed_s(stack, since)) == pytest.approx(PUSH_s, abs=0.1)
                stack.until(lambda seen=read: looking.read[0] > seen + 10, 10, "the page goes on")
                assert (stack.mode, stack.state.drive_state) == (Status.MODE_ACTIVE, State.DRIVE_ON)
        states = stack.user.since("JOINT_STATE", begun)
        beside = [state.time_ns - state.seq * state.period_ns for state in states]
        assert np.ptp(beside) == 0, "each cycle in its time"
        client.stdin.close()
        assert client.wait(timeout=300) == 0
        monitor.send_signal(signal.SIGINT)
        assert "messages received" in monitor.communicate(timeout=300)[0]
        recorder.send_signal(signal.SIGINT)
        assert recorder.wait(timeout=300) == 0
    recorded = Log(log)
    assert recorded.length_s < MOST_s
    for channel in recorded.channels:
        assert np.all(np.diff(recorded.stamps_s(channel)) >= 0), channel
