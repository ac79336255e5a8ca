"""The shared-memory arm plane's ring and waits under thread sanitizer: one thread for each end."""

import subprocess

from conftest import ROOT


def test_no_race_between_the_ends_of_the_ring(programs, races):
    program = ROOT / "build" / "tsan" / "tests" / "test_common"
    command = [program, "--gtest_filter=SharedRing*:SharedMemory*"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert not races(), "\n".join(races())
    assert done.returncode == 0, done.stdout + done.stderr
