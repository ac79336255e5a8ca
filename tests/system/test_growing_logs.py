"""A log that is read while it is recorded, and one that is cut: what is whole is read, no command
ends without a word.
"""

import signal
import subprocess
import time
from contextlib import contextmanager

import lcm
import pytest
from processes import started

from limber.lcmtypes.joint_state_t import joint_state_t
from limber.log.reader import Log
from stack import BIN, ROOT, USER_URL

LIMBER = str(ROOT / ".venv" / "bin" / "limber")
STATES = 3000


@contextmanager
def recording(path):
    with started([BIN / "limber-record", "--out", path], stdout=subprocess.PIPE) as recorder:
        yield recorder
        recorder.send_signal(signal.SIGINT)


def send(line: lcm.LCM, first: int) -> None:
    state = joint_state_t()
    for state.seq in range(first, first + STATES):
        line.publish("JOINT_STATE", state.encode())
        if state.seq % 100 == 99:
            time.sleep(0.005)


def until_larger(path, line, size: int, first: int) -> int:
    """The next number."""
    end = time.monotonic() + 60
    while not path.exists() or path.stat().st_size <= size:
        assert time.monotonic() < end, "nothing is written"
        send(line, first)
        first += STATES
    return first


@pytest.mark.parametrize("name", ["run.lcmlog", "run.lcmlog.zst"])
def test_a_log_is_read_while_it_grows(tmp_path, name):
    path, line = tmp_path / name, lcm.LCM(USER_URL)
    with recording(path):
        next_one = until_larger(path, line, 100_000, 0)
        early = Log(path)
        before = early.read("JOINT_STATE")["seq"].tolist()
        assert before == list(range(before[0], before[0] + len(before)))
        with started(
            [LIMBER, "log", "rate", path],
            cwd=ROOT,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
        ) as reader:
            while reader.poll() is None:
                send(line, next_one)
                next_one += STATES
            told = reader.stdout.read().decode()
        assert reader.returncode == 0, told
        assert "JOINT_STATE" in told and "Traceback" not in told
        assert early.read("JOINT_STATE")["seq"].tolist() == before
        later = Log(path).read("JOINT_STATE")["seq"].tolist()
        assert later[: len(before)] == before and len(later) > len(before)
