"""`limber dev check-trace`: the exit code is the verdict, the table names the breach."""

import subprocess
import sys

import pytest
from wire import STEP_Nm, Wire, command


def check_trace(*words) -> subprocess.CompletedProcess:
    line = [sys.executable, "-m", "limber", "dev", "check-trace", *map(str, words)]
    return subprocess.run(line, capture_output=True, text=True, check=False)


@pytest.fixture
def trace(tmp_path):
    path = tmp_path / "trace.log"

    def write(*torques: float):
        wire = Wire()
        for torque in torques:
            wire.step(command(torque))
        path.write_text("\n".join(wire.lines), encoding="ascii")
        return path

    return write


def test_no_breach(trace):
    done = check_trace(trace(0.0, STEP_Nm, 2 * STEP_Nm), "--robot", "desktop2r")
    assert done.returncode == 0, done.stderr
    assert "no breach: 6 commands, 6 states" in done.stdout


def test_a_breach_is_named(trace):
    done = check_trace(trace(0.0, 0.0, 1.0), "--robot", "desktop2r")
    assert done.returncode == 1
    for word in ("0.0020", "shoulder", "rate", "0.35", "N m", "1 breaches"):
        assert word in done.stdout


def test_a_bus_of_another_name(trace):
    path = trace(0.0, 0.0, 1.0)
    path.write_text(path.read_text().replace("desktop2r", "can3"), encoding="ascii")
    done = check_trace(path, "--robot", "desktop2r", "--bus", "arm=socketcan:can3")
    assert done.returncode == 1
    assert "rate" in done.stdout


def test_a_stop_that_is_missed(trace):
    words = ("--robot", "desktop2r", "--fault-at", 0.001, "--stop-within", 1)
    done = check_trace(trace(0.0, 0.0, 0.0, 0.0), *words)
    assert done.returncode == 1
    assert "without a safe frame" in done.stdout


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["missing.log"], "does not exist"),
        (["{trace}", "--robot", "unheard_of"], "planar2r"),
        (["{trace}", "--robot", "openarm"], "desktop2r"),
        (["{trace}", "--fault-at", "-1"], "--fault-at"),
        (["{trace}", "--robot", "desktop2r", "--bus", "arm=can0"], "socketcan:IFACE"),
        (["{trace}", "--robot", "desktop2r", "--bus", "leg=socketcan:can0"], "buses are arm"),
    ],
)
def test_what_is_wrong_is_told_in_a_line(trace, words, told):
    path = str(trace(0.0))
    done = check_trace(*(word.replace("{trace}", path) for word in words))
    assert done.returncode == 2
    assert told in done.stderr
    assert len(done.stderr.splitlines()) == 1
