"""`limber bench` measures the real controller's round trip."""

import json
import subprocess

from stack import BIN


def test_the_controller_answers_in_active():
    command = [BIN / "limber-bench-loop", "--controller", BIN / "limber-controller"]
    done = subprocess.run(
        [*command, "--rounds", "400"], capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["rounds"] == 400
    assert 0 < found["limber_us"]["p50"] <= found["limber_us"]["p99"]
