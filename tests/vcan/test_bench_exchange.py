"""The exchange that `limber dev bench` measures, over the kernel's CAN."""

import json
import subprocess

from stack import BIN


def test_the_drives_answer_over_vcan():
    """However long this machine stands still: the window is that of a slow arm, 0.3 s."""
    command = [BIN / "limber-bench-exchange", "--vcan", "--rounds", "400", "--rate", "2"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["rounds"] == 400
    assert found["late"] == 0
    assert 0 < found["own_ns"]["p50"] <= found["own_ns"]["p99"]
    assert 0 < found["bare_ns"]["p50"] <= found["bare_ns"]["p99"]
