"""`limber bench` measures the real controller's round trip."""

import json
import subprocess

from stack import BIN, ROOT


def test_the_controller_answers_in_active():
    command = [BIN / "limber-bench-loop", "--controller", BIN / "limber-controller"]
    done = subprocess.run(
        [*command, "--rounds", "400"], capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["rounds"] == 400
    assert 0 < found["limber_us"]["p50"] <= found["limber_us"]["p99"]


def test_the_three_processes_are_timed():
    scenario = ROOT / "bench" / "whole_loop.yaml"
    command = [BIN / "limber-bench-whole-loop", "--bin", BIN, "--scenario", scenario]
    done = subprocess.run(
        [*command, "--turns", "1"], capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["ratio"] > 0
