"""Targets with times from a script to the real processes."""

import subprocess
import sys
import time

import numpy as np
import pytest
from processes import started

from limber import Arm, RefusedError
from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber.live.script_client import script_client


@pytest.fixture
def standing(stack):
    stack.robot = "openarm"
    stack.start_all()
    stack.until(lambda: stack.mode == Status.MODE_IDLE, 20, "IDLE")
    return stack


def test_a_stream_is_followed_and_rests_when_it_ends(standing):
    with Arm() as arm:
        arm.activate()
        start, first_s = arm.goal, arm.time_s
        stream = arm.stream(rate_hz=30)
        for state in arm.states(hz=30):
            t = state.time_s - first_s
            if t > 2.0:
                break
            up = np.array([0.0, 0.0, 0.04 * (1 - np.cos(2 * t))])
            stream.send(position_m=start.p + up)
        arm.wait(until=lambda now: now.targets.state == "waiting", timeout_s=5)
        state = arm.state
        assert state.mode == "active"
        assert state.targets.taken >= 55 and state.targets.refused == state.targets.stale == 0
        assert state.targets.starved == 1
        assert 0.03 < arm.goal.p[2] - start.p[2] < 0.09
        arm.chunk(0.05, joints_rad=np.tile(arm.q, (20, 1)))  # a law for the tip follows joints
        arm.wait(until=lambda now: now.targets.state == "running", timeout_s=5)
        assert "RATE" not in arm.limits


def test_a_refused_target_is_told_by_the_next(standing):
    with Arm() as arm:
        arm.activate()
        stream = arm.stream()
        stream.send(time_s=arm.time_s + 30, joints_rad=arm.q)
        with pytest.raises(RefusedError, match="more than 5 s ahead"):
            for _ in range(100):
                stream.send(joints_rad=arm.q)
                time.sleep(0.02)


STREAM = """
from limber import Arm
arm = Arm()
arm.activate()
stream = arm.stream(rate_hz=30)
for state in arm.states(hz=30):
    stream.send(twist=[0, 0, 0.03, 0, 0, 0])
    print(".", flush=True)
"""


def test_a_killed_policy_is_followed_by_the_next_at_once(standing):
    with started([sys.executable, "-c", STREAM], stdout=subprocess.PIPE, text=True) as script:
        for _ in range(20):
            assert script.stdout.readline() == ".\n"
        script.kill()
        script.wait()
    stopped = standing.user.latest("CONTROLLER_STATUS")
    assert stopped.mode == Status.MODE_ACTIVE
    with Arm() as arm:  # no stop, no wait, no request but its own
        arm.activate()
        arm.stream().send(joints_rad=arm.q)
        arm.wait(until=lambda now: now.targets.taken > stopped.stream_taken, timeout_s=5)
        assert arm.mode == "active"


def test_a_script_that_lives_keeps_its_lease(standing):
    with started([sys.executable, "-c", STREAM], stdout=subprocess.PIPE, text=True) as script:
        for _ in range(5):
            assert script.stdout.readline() == ".\n"
        with Arm() as arm, pytest.raises(RefusedError, match="another client holds the lease"):
            arm.gains(damping_ratio=0.9)
        script.kill()


def test_scripts_at_the_same_time_have_different_numbers(standing):
    code = "from limber.live.script_client import script_client; print(script_client()); input()"
    with started(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as other:
        assert int(other.stdout.readline()) != script_client()
        other.kill()


def test_torques_on_top_at_500_hz_make_no_cycle_late(standing):
    with Arm() as arm:
        arm.activate()
        before = arm.state.status
        for k in range(500):
            torque = np.zeros(7)
            torque[5] = 0.3 * np.sin(0.05 * k)
            arm.overlay(torque, for_s=0.02)
            time.sleep(0.002)
        status = arm.state.status
        assert status["overlays_taken"] - before["overlays_taken"] >= 490
        assert arm.mode == "active"
        assert sum(arm.lost.values()) == 0
