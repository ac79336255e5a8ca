"""Unit tests with a thread for each end under thread sanitizer."""

import subprocess

import pytest

from limber.paths import ROOT


@pytest.mark.parametrize(
    ("program", "tests"),
    [
        ("test_common", "SharedRing*:SharedMemory*"),
        ("test_can", "SharedBus*"),
        ("test_driver_processes", "StateReporter*"),
    ],
    ids=["arm plane", "virtual bus", "lines of the driver"],
)
def test_no_race_between_threads(programs, races, program, tests):
    command = [ROOT / "build" / "tsan" / "tests" / program, f"--gtest_filter={tests}"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert not races(), "\n".join(races())
    assert done.returncode == 0, done.stdout + done.stderr
