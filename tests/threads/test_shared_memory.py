"""Rings and waits in shared memory under thread sanitizer: one thread for each end."""

import subprocess

import pytest

from limber.paths import ROOT


@pytest.mark.parametrize(
    ("program", "tests"),
    [("test_common", "SharedRing*:SharedMemory*"), ("test_can", "SharedBus*")],
    ids=["arm plane", "virtual bus"],
)
def test_no_race_between_the_ends_of_the_ring(programs, races, program, tests):
    command = [ROOT / "build" / "tsan" / "tests" / program, f"--gtest_filter={tests}"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert not races(), "\n".join(races())
    assert done.returncode == 0, done.stdout + done.stderr
