"""Simulated time waits for the machine: beside endless loops, stopped processes and live requests
nothing is late, nothing is lost, and every run has the bytes of the lab.
"""

import signal
import subprocess
import sys
import threading
import time
from contextlib import contextmanager
from pathlib import Path

import lcm
import numpy as np
import pytest
import yaml
from processes import started

from limber import Arm
from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber.lcmtypes.joint_state_t import joint_state_t as State
from same_bytes import expect_equal, of_the_lab, of_three_processes, payloads
from stack import BIN, ROOT, USER_URL

LIMBER = str(ROOT / ".venv" / "bin" / "limber")
LOOP = "while True: pass"
HOWS = {"three processes": (), "one process": ("--one-process",)}


def paced(folder: Path, seconds: float = 2.0) -> Path:
    """A scenario with a bit of everything, for whoever watches."""
    scenario = yaml.safe_load((ROOT / "scenarios" / "quick.yaml").read_text(encoding="utf-8"))
    scenario.pop("measure", None)
    scenario |= {"mode": "realtime", "duration_s": seconds}
    scenario["timeline"] = [e for e in scenario["timeline"] if e["at_s"] < seconds]
    path = folder / "paced.yaml"
    path.write_text(yaml.safe_dump(scenario), encoding="utf-8")
    return path


@contextmanager
def endless_loops(count: int):
    loops = [subprocess.Popen([sys.executable, "-c", LOOP]) for _ in range(count)]
    try:
        yield
    finally:
        for loop in loops:
            loop.kill()
            loop.wait()


@pytest.mark.parametrize("how", HOWS)
def test_the_bytes_are_those_of_the_lab_beside_endless_loops(how, tmp_path):
    scenario = paced(tmp_path)
    lab = of_the_lab(scenario, tmp_path)
    with endless_loops(3):
        run = of_three_processes(scenario, tmp_path / "run", pace=HOWS[how])
    expect_equal(run, lab, how)


def test_without_a_clock_one_process_is_the_same(tmp_path):
    scenario = paced(tmp_path)
    lab = of_the_lab(scenario, tmp_path)
    run = of_three_processes(scenario, tmp_path / "run", pace=("--lockstep", "--one-process"))
    expect_equal(run, lab, "one process, no clock")


def test_a_paced_run_takes_its_time(tmp_path):
    scenario = paced(tmp_path)
    for how, options in HOWS.items():
        out = tmp_path / how.replace(" ", "_")
        begun_s = time.monotonic()
        of_three_processes(scenario, out, pace=options)
        assert time.monotonic() - begun_s > 2.0, how


@pytest.mark.parametrize("name", ["sim", "controller", "driver"])
def test_a_process_that_stands_still_stops_time_and_nothing_else(stack, name):
    stack.start_all()
    stack.bring_to(Status.MODE_ACTIVE)
    stack.pass_time(1.0)
    states = stack.user.count("JOINT_STATE")
    stack.processes[name].send_signal(signal.SIGSTOP)
    time.sleep(0.3)
    before_s = stack.time_s
    time.sleep(0.7)
    assert stack.time_s == before_s
    stack.processes[name].send_signal(signal.SIGCONT)
    stack.pass_time(0.5)
    assert (stack.mode, stack.state.drive_state) == (Status.MODE_ACTIVE, State.DRIVE_ON)
    seen = stack.user.since("JOINT_STATE", states)
    assert {state.fault for state in seen} == {State.FAULT_NONE}
    assert np.all(np.diff([state.seq for state in seen]) == 1)
    assert sum(stack.driver_status.replies_lost) == stack.driver_status.commands_missing == 0


def test_after_a_pause_nothing_sprints(stack):
    """A second that was lost is not made up for: the arm is as slow as ever."""
    stack.start_all()
    stack.bring_to(Status.MODE_HOLD)
    driver = stack.processes["driver"]
    driver.send_signal(signal.SIGSTOP)
    time.sleep(1.0)
    before_s, begun_s = stack.time_s, time.monotonic()
    driver.send_signal(signal.SIGCONT)
    time.sleep(0.5)
    passed_s = stack.time_s - before_s
    assert passed_s < time.monotonic() - begun_s + 0.1


def slowed(stop: threading.Event, process: subprocess.Popen) -> None:
    """It has a fifth of the time."""
    while not stop.is_set():
        process.send_signal(signal.SIGSTOP)
        time.sleep(0.08)
        process.send_signal(signal.SIGCONT)
        time.sleep(0.02)


def test_a_run_that_falls_behind_tells_by_how_much_and_what_helps(stack):
    stack.start_all()
    stack.until(lambda: stack.mode == Status.MODE_IDLE, 20, "IDLE")
    stop = threading.Event()
    brake = threading.Thread(target=slowed, args=(stop, stack.processes["sim"]))
    brake.start()
    try:
        stack.until(lambda: "of real time" in stack.log("driver"), 30, "the driver to tell")
    finally:
        stop.set()
        brake.join()
    told = stack.log("driver")
    assert "warning: simulated time runs at " in told
    assert "--one-process" in told and "load average" in told
    assert stack.mode == Status.MODE_IDLE


@contextmanager
def one_process(folder: Path):
    """`limber run --one-process` of an arm that waits to be asked."""
    command = [LIMBER, "run", str(ROOT / "scenarios" / "ready.yaml"), "--one-process"]
    command += ["--record-plain", "--record", "--out", str(folder)]
    with started(command, stdout=subprocess.PIPE, text=True) as running:
        try:
            yield running
        finally:
            if running.poll() is None:
                running.send_signal(signal.SIGINT)


def test_one_process_is_a_running_arm(tmp_path):
    folder = tmp_path / "out"
    with one_process(folder) as running:
        end_s = time.monotonic() + 60
        log = folder / "limber-lab.log"
        while not log.exists() or "mode ACTIVE" not in log.read_text(encoding="utf-8"):
            assert time.monotonic() < end_s and running.poll() is None
            time.sleep(0.05)
        watched = subprocess.run([LIMBER, "watch", "--once"], capture_output=True, text=True)
        assert "openarm" in watched.stdout, watched.stderr
        with Arm() as arm:
            assert arm.simulated
            arm.wait(until=lambda state: state.time_s > 1.7)  # the scenario's own lease is over
            arm.activate()
            for garbage in (b"", b"\xff" * 40):
                lcm.LCM(USER_URL).publish("MODE_REQUEST", garbage)
            start = arm.goal
            there = arm.move([0, 0, 0.03], duration_s=0.5)
            np.testing.assert_allclose(there.goal.p, np.add(start.p, [0, 0, 0.03]), atol=1e-9)
            before = arm.pose.p
            arm.push([0, 9, 0], for_s=2.0, ramp_s=0.3)
            pushed = arm.wait(for_s=1.0)
            assert pushed.pose.p[1] - before[1] > 5e-3
        second = subprocess.run(
            [str(BIN / "limber-driver"), "--paced"], capture_output=True, text=True, timeout=300
        )
        assert second.returncode == 2 and "there is already a driver" in second.stderr
        running.send_signal(signal.SIGINT)
        shown, _ = running.communicate(timeout=300)
    assert running.returncode == 0, shown
    assert "stopped" in shown
    recorded = payloads(folder / "run.lcmlog")
    assert len(recorded["JOINT_STATE"]) > 1000
    assert Status.decode(recorded["CONTROLLER_STATUS"][-1]).messages_undecodable == 2
    channels = {event.channel for event in lcm.EventLog(str(folder / "run.lcmlog"))}
    assert {"COMPLIANCE_GOAL", "MODE_REQUEST", "PUSH", "REQUEST_ANSWER"} <= channels


def test_one_process_is_for_simulated_arms(tmp_path):
    for option in ("--realtime", "--no-sim"):
        done = subprocess.run(
            [LIMBER, "run", str(paced(tmp_path)), "--one-process", option],
            capture_output=True,
            text=True,
            cwd=tmp_path,
        )
        assert done.returncode == 2
        assert "--one-process: simulated arms only" in done.stderr
