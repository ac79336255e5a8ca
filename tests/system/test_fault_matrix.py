"""Faults of processes, planes and the start, injected into the real processes: the rows of
qa/faults/matrix.yaml that name these tests.

The trace checker judges what was on the bus meanwhile: every test here takes `judged`.
"""

import resource
import signal
import subprocess
import time

import numpy as np
import pytest

from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber.lcmtypes.joint_state_t import joint_state_t as State
from stack import BIN, ROOT, Stack

DEGREE = np.pi / 180
FREEZE_s = 0.6  # longer than any watchdog waits


def active(stack: Stack) -> None:
    stack.start_all()
    stack.bring_to(Status.MODE_ACTIVE)
    time.sleep(0.8)  # let the fade-in of the law pass


def freeze(stack: Stack, tag: str, seconds: float = FREEZE_s) -> None:
    stack.processes[tag].send_signal(signal.SIGSTOP)
    time.sleep(seconds)
    stack.processes[tag].send_signal(signal.SIGCONT)


def speed_since(stack: Stack, index: int) -> float:
    truths = stack.user.since("SIM_TRUTH", index)
    return max(np.abs(truth.v[: truth.num_joints]).max() for truth in truths)


@pytest.mark.realtime
def test_a_controller_that_freezes_is_not_followed_again(judged):
    active(judged)
    before = judged.positions
    freeze(judged, "controller")
    judged.until(lambda: judged.state.drive_state == State.DRIVE_HOLD, 5, "the drives to hold")
    time.sleep(0.5)
    assert judged.state.drive_state == State.DRIVE_HOLD, "thawed, it asks for nothing"
    assert judged.state.fault == State.FAULT_CONTROLLER_LOST
    assert judged.mode == Status.MODE_FAULT
    assert np.abs(judged.positions - before).max() < 3 * DEGREE
    judged.acknowledge()
    judged.bring_to(Status.MODE_HOLD)
    judged.until(lambda: judged.state.drive_state == State.DRIVE_ON, 5, "the drives to obey")


@pytest.mark.realtime
def test_a_driver_that_freezes_sends_no_old_commands(judged):
    active(judged)
    index = judged.user.count("SIM_TRUTH")
    freeze(judged, "driver")
    thawed = judged.user.count("SIM_TRUTH")
    judged.until(lambda: judged.state.drive_state != State.DRIVE_ON, 5, "the driver to notice")
    time.sleep(0.5)
    assert judged.mode == Status.MODE_FAULT
    assert speed_since(judged, index) < 2.0, "on shorted phases the arm sinks slowly"
    # What the motors make now is braking: it takes energy out of the arm.
    for truth in judged.user.since("SIM_TRUTH", thawed)[50:]:
        power_W = np.array(truth.tau_motor) * np.array(truth.theta_dot)
        assert power_W.max() < 0.5, "a torque that drives the arm"


@pytest.mark.realtime
def test_an_arm_that_comes_back_elsewhere_stays_there(judged):
    active(judged)
    home = judged.positions
    judged.kill("sim")
    judged.until(lambda: judged.mode == Status.MODE_FAULT, 5, "FAULT")
    elsewhere = home + np.array([0.2, 0.1, -0.2, 0.2, 0.1, -0.1, 0.2])
    judged.start("sim", "--start-q", *map(str, elsewhere))
    time.sleep(1.0)
    assert np.abs(judged.positions - elsewhere).max() < 1 * DEGREE, "it lies in its stand"
    judged.acknowledge()
    judged.bring_to(Status.MODE_HOLD)
    judged.until(lambda: judged.state.drive_state == State.DRIVE_ON, 10, "drives on")
    time.sleep(1.0)
    assert np.abs(judged.positions - elsewhere).max() < 6 * DEGREE, "not to the old goal"


def test_a_recorder_that_hangs_is_not_noticed(judged, tmp_path):
    recorder = subprocess.Popen([BIN / "limber-record", "--out", tmp_path / "run.lcmlog"])
    try:
        active(judged)
        recorder.send_signal(signal.SIGSTOP)
        time.sleep(2.0)
        assert judged.state.drive_state == State.DRIVE_ON, judged.describe()
        recorder.kill()
        time.sleep(0.5)
        assert judged.state.drive_state == State.DRIVE_ON, judged.describe()
        assert judged.mode == Status.MODE_ACTIVE
    finally:
        recorder.kill()
        recorder.wait()


@pytest.mark.realtime
def test_a_simulator_that_stalls_is_a_fault(judged):
    active(judged)
    freeze(judged, "sim")
    judged.until(lambda: judged.mode == Status.MODE_FAULT, 5, "FAULT")
    assert judged.state.fault == State.FAULT_REPLY_LOST
    assert judged.state.drive_state != State.DRIVE_ON
    judged.acknowledge()
    judged.bring_to(Status.MODE_HOLD)
    judged.until(lambda: judged.state.drive_state == State.DRIVE_ON, 10, "drives on")


def test_a_flood_of_telemetry_stops_no_arm(judged):
    active(judged)
    before = judged.positions
    end = time.monotonic() + 3.0
    sent = 0
    while time.monotonic() < end:
        for _ in range(10):
            judged.user.lcm.publish("FOREIGN", b"x" * 200)
            sent += 1
        time.sleep(0.002)
    assert sent > 1000
    assert judged.state.drive_state == State.DRIVE_ON, judged.describe()
    assert judged.mode == Status.MODE_ACTIVE
    assert np.abs(judged.positions - before).max() < 1 * DEGREE


@pytest.mark.realtime
def test_replayed_requests_enable_nothing(judged):
    """An old log, played to the user plane of a stack that has been started anew."""
    active(judged)
    old = list(judged.user.raw["MODE_REQUEST"])
    assert old, "the requests that brought the arm up"
    for tag in list(judged.processes):
        judged.kill(tag)
    judged.start_all()
    judged.until(lambda: judged.mode == Status.MODE_IDLE, 10, "IDLE")
    judged.until(lambda: judged.state.drive_state == State.DRIVE_OFF, 5, "drives off")
    for _ in range(20):
        for data in old:
            judged.user.lcm.publish("MODE_REQUEST", data)
        time.sleep(0.1)
    assert judged.state.drive_state == State.DRIVE_OFF


@pytest.mark.realtime
def test_a_network_that_goes_down_is_a_fault(judged):
    active(judged)
    before = judged.positions
    _ip("link", "set", "lo", "down")
    time.sleep(FREEZE_s)
    _ip("link", "set", "lo", "up")
    _ip("route", "replace", "224.0.0.0/4", "dev", "lo")
    judged.until(lambda: judged.mode == Status.MODE_FAULT, 10, "FAULT")
    assert judged.state.drive_state != State.DRIVE_ON
    assert np.abs(judged.positions - before).max() < 30 * DEGREE, "it sank on shorted phases"
    judged.acknowledge()
    judged.bring_to(Status.MODE_HOLD)
    judged.until(lambda: judged.state.drive_state == State.DRIVE_ON, 10, "drives on")


def _ip(*words: str) -> None:
    subprocess.run(["ip", *words], check=True)


def start_with_descriptors(count: int) -> subprocess.CompletedProcess:
    return subprocess.run(
        [BIN / "limber-driver", "--robot", ROOT / "robots" / "openarm"],
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (count, count)),
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


def test_without_descriptors_the_driver_does_not_start():
    done = start_with_descriptors(16)
    assert done.returncode == 2
    assert "open files" in done.stderr


def test_with_hardly_any_descriptors_the_driver_says_so():
    done = start_with_descriptors(10)
    assert done.returncode > 0, f"ended by signal {-done.returncode}"
    assert done.stderr.strip()
