"""Logs that were made, or changed, by somebody who means no good."""

import mmap
import os
import subprocess
import sys

import numpy as np
import pytest
import zstandard
from made_logs import event_bytes, records, write_log
from processes import started

from limber.log import compressed
from limber.log.reader import Log, count_gaps, count_jumps
from limber.messages import message_class
from limber.paths import ROOT

MB = 1 << 20


def test_an_absurd_number_is_a_jump_and_no_loss(limber, tmp_path):
    truth = records("sim_truth_t", 100, time_ns=np.arange(100) * 10**6)
    truth[truth.dtype.names[1]][50] = 6 * 10**18
    path = write_log(tmp_path / "log", {"SIM_TRUTH": truth})
    assert (Log(path).lost("SIM_TRUTH"), Log(path).jumps("SIM_TRUTH")) == (0, 2)
    told = limber("log", "info", str(path)).stdout
    assert "SIM_TRUTH: 2 jumps of its numbers are too great for a loss" in told
    assert "6000000000" not in told


def test_numbers_that_wrap_around():
    assert count_gaps(np.array([-(2**63) + 1, 2**63 - 1, 3, 4, 6])) == 1
    assert count_jumps(np.array([-(2**63) + 1, 2**63 - 1, 3, 4, 6])) == 2
    assert (count_gaps(np.array([1, 2, 9_000_002])), count_jumps(np.array([1, 2]))) == (
        8_999_999,
        0,
    )


@pytest.mark.parametrize("name", ["push_t", "scenario_event_t", "request_answer_t"])
def test_what_cannot_be_decoded_is_counted(limber, name, tmp_path):
    """Right type, cut off; and something else."""
    channel = {"push_t": "PUSH", "scenario_event_t": "SCENARIO_EVENT"}.get(name, "REQUEST_ANSWER")
    good = message_class(name)().encode()
    path = tmp_path / "log"
    path.write_bytes(
        b"".join(
            event_bytes(channel, data, i) for i, data in enumerate([good, good[:-1], b"x" * 40])
        )
    )
    assert Log(path).undecodable(channel) == 2
    row = next(
        line for line in limber("log", "info", str(path)).stdout.splitlines() if channel in line
    )
    assert row.split()[2:5] == ["3", "0", "2"]


class Counting:
    """A file that is not kept."""

    def __init__(self) -> None:
        self.size = self.largest = 0

    def write(self, data: bytes) -> None:
        self.size += len(data)
        self.largest = max(self.largest, len(data))

    def tell(self) -> int:
        return self.size


def test_a_small_log_that_is_large_unpacked_is_unpacked_in_pieces(tmp_path):
    size = 400 * MB
    packed = zstandard.ZstdCompressor(level=1).compress(bytes(size))
    assert len(packed) < 64 << 10
    path = tmp_path / "log.zst"
    path.write_bytes(packed)
    plain = Counting()
    with open(path, "rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
        assert compressed._unpack(data, plain) == (0, 0)
    assert plain.size == size
    assert plain.largest <= 100 * MB


READING = """
import sys, time
from limber.errors import LimberError
from limber.log.reader import Log
try:
    log = Log(sys.argv[1])
    print("open", flush=True)
    while True:
        log._arrays.clear()
        log.read("JOINT_STATE")
except LimberError as error:
    print(error)
    sys.exit(error.exit_code)
"""


@pytest.mark.parametrize("how", ["cut", "written to"])
def test_a_log_that_changes_while_it_is_read_is_given_up_with_a_word(how, tmp_path):
    path = write_log(tmp_path / "log", {"JOINT_STATE": records("joint_state_t", 5000)})
    command = [sys.executable, "-c", READING, str(path)]
    with started(command, stdout=subprocess.PIPE, text=True, cwd=ROOT) as reader:
        assert reader.stdout.readline() == "open\n"
        if how == "cut":
            os.truncate(path, 1000)
        else:
            path.write_bytes(b"x")
        assert "is cut, or written to, while it is read" in reader.stdout.read()
        assert reader.wait() == 3


@pytest.mark.parametrize(
    "environment", [{"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}]
)
def test_texts_are_utf8_whatever_the_locale_is(environment, tmp_path):
    answer = message_class("request_answer_t")()
    answer.reason, answer.kind = "über 20 °C", 1
    path = tmp_path / "log"
    path.write_bytes(event_bytes("REQUEST_ANSWER", answer.encode()))
    done = subprocess.run(
        [sys.executable, "-m", "limber", "log", "events", str(path), "--robot", "desktop2r"],
        capture_output=True,
        env=os.environ | environment,
        cwd=ROOT,
    )
    assert done.returncode == 0, done.stderr
