"""The programs of `limber dev bench` do what they measure."""

import json
import subprocess

import pytest

from stack import BIN, ROOT


def test_the_controller_answers_in_active():
    command = [BIN / "limber-bench-loop", "--controller", BIN / "limber-controller"]
    done = subprocess.run(
        [*command, "--rounds", "400"], capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["rounds"] == 400
    assert 0 < found["limber_us"]["p50"] <= found["limber_us"]["p99"]


def run(program: str, *options: str) -> dict:
    done = subprocess.run(
        [BIN / program, *options], capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_the_drives_answer_over_the_virtual_bus():
    found = run("limber-bench-exchange", "--rounds", "400")
    assert found["rounds"] == 400
    assert found["late"] < 200
    assert 0 < found["own_ns"]["p50"] <= found["own_ns"]["p99"]
    assert 0 < found["bare_ns"]["p50"] <= found["bare_ns"]["p99"]


def test_a_cycle_asks_nothing_of_heap_and_kernel():
    cycles = 20_000
    found = run("limber-bench-calls", "--cycles", str(cycles))
    assert found.pop("cycles") == cycles
    assert found == {"heap_requests": 0, "page_faults": 0, "futex_calls": 0}


@pytest.mark.parametrize("options", [(), ("--plain",)])
def test_each_cycle_is_timed(options):
    found = run("limber-bench-lateness", "--seconds", "0.2", *options)
    assert found["cycles"] == 200
    assert 0 <= found["p50_ns"] <= found["p99_ns"]
    assert 0 <= found["overruns"] <= 200


def test_the_publisher_sends_what_is_due():
    found = run("limber-bench-publisher", "--rate", "5000", "--seconds", "0.2")
    assert found["sent"] == 1000
    assert found["seconds"] > 0.19


def test_the_three_processes_are_timed():
    scenario = str(ROOT / "qa" / "bench" / "whole_loop.yaml")
    options = ("--bin", str(BIN), "--scenario", scenario, "--turns", "1")
    assert run("limber-bench-whole-loop", *options)["ratio"] > 0
