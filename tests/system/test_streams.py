"""Targets with times from a script to the real processes."""

import signal
import struct
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from processes import started

from limber import Arm, RefusedError, messages
from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber.live import stream_messages
from limber.live.line import Line
from limber.live.script_client import script_client
from limber.model.robot import load_robot
from stack import USER_URL


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


def test_a_target_does_not_wait_for_another_threads_request(standing):
    controller = standing.processes["controller"]
    with Arm() as arm:
        arm.activate()
        stream, before = arm.stream(), arm.targets.taken
        controller.send_signal(signal.SIGSTOP)
        asking = threading.Thread(target=arm.gains, kwargs={"damping_ratio": 0.9})
        asking.start()
        while not arm._port._turn.locked():
            time.sleep(0.001)
        for _ in range(3):
            stream.send(joints_rad=arm.q)
        assert asking.is_alive(), "there is no answer yet"
        controller.send_signal(signal.SIGCONT)
        asking.join()
        arm.wait(until=lambda now: now.targets.taken == before + 3, timeout_s=5)


def test_torques_on_top_at_500_hz_leave_no_state_unanswered(standing):
    with Arm() as arm:
        arm.activate()
        before, first = arm.state.status, standing.user.count("JOINT_TORQUE")
        for k in range(500):
            torque = np.zeros(7)
            torque[5] = 0.3 * np.sin(0.05 * k)
            arm.overlay(torque, for_s=0.02)
            time.sleep(0.002)
        status = arm.state.status
        assert status["overlays_taken"] - before["overlays_taken"] >= 490
        assert arm.mode == "active"
        assert sum(arm.lost.values()) == 0
        assert standing.driver_status.commands_missing == 0
        passes_no_limit(standing, first)


class Flood:
    """Sends TARGET_STREAMs of the arm's client, with bytes changed where the moment needs it."""

    SEQ, CLIENT_AND_RUN, T0 = 8, 24, 40

    def __init__(self, arm: Arm) -> None:
        self.arm, self.line = arm, Line(USER_URL)
        self.random = np.random.default_rng(7)
        self.home = arm.q
        self.who = struct.pack(">qq", int(arm.state.status["controller"]), arm._port.client)

    def message(self, wrong: str = "") -> bytes:
        """Up to 0.3 rad beside where the arm was, three knots; or wrong in one way."""
        knots = self.home + self.random.uniform(-0.3, 0.3, (3, 7))
        given = {"joints_rad": knots, "delay_s": float(self.random.uniform(0.0, 0.1))}
        (made,) = stream_messages.targets(7, np.array([0.0, 0.02, 0.05]), given)
        if wrong == "nan":
            made.value[1][3] = np.nan
        elif wrong == "kind":
            made.kind = 9
        elif wrong == "beyond":
            made.value[0][0] = 1e6
        elif wrong == "dt":
            made.dt_s[1] = made.dt_s[2]
        return made.encode()

    def send(self, data: bytes, after_s: float = 0.0, seq_before: int = 0) -> None:
        made = bytearray(data)
        seq = time.monotonic_ns() - seq_before
        struct.pack_into(">q", made, self.SEQ, seq)
        made[self.CLIENT_AND_RUN : self.CLIENT_AND_RUN + 16] = self.who
        t0_ns = round(1e9 * (self.arm.time_s + after_s))
        struct.pack_into(">q", made, self.T0, max(t0_ns, 0))
        self.line.publish("TARGET_STREAM", bytes(made))


def counts(arm: Arm) -> np.ndarray:
    """Taken, late, stale, refused."""
    found = arm.state.targets
    return np.array([found.taken, found.late, found.stale, found.refused])


def passes_no_limit(stack, first: int) -> None:
    """Torques from that message on, and the goal's speed, whatever has come."""
    robot = load_robot("openarm").resolved
    limit = np.array([joint["torque_limit_Nm"] for joint in robot["joints"]])
    rate = np.array([joint["torque_rate_limit_Nm_per_s"] for joint in robot["joints"]])
    sent = messages.views("joint_command_t", stack.user.raw["JOINT_TORQUE"][first:])
    tau = sent["tau"][:, :7]
    assert len(sent) > 500 and (np.abs(tau) <= limit * (1 + 1e-9)).all()
    follows = np.diff(sent["state_seq"]) == 1
    assert (np.abs(np.diff(tau, axis=0))[follows] <= 1e-3 * rate * (1 + 1e-9)).all()


@pytest.mark.parametrize("law", ["cartesian_impedance", "joint_impedance"])
def test_a_flood_of_targets_passes_no_limit_and_is_counted(standing, law):
    """10,000 a second for two seconds, good and wrong ones, from the past and the future, twice and
    out of order. The queue holds eight a cycle: what does not fit is dropped, and never half read.
    """
    with Arm() as arm:
        arm.activate()
        arm.gains(law)
        arm.wait(for_s=0.5)
        flood = Flood(arm)
        kinds = [""] * 12 + ["nan", "kind", "beyond", "dt"]
        ready = [flood.message(kind) for kind in kinds * 8]
        when = [0.0] * 4 + [-0.15, -0.3, -10.0, 2.0, 6.0, 1e9]
        refused_before = np.array(standing.driver_status.commands_refused)
        first, before = standing.user.count("JOINT_TORQUE"), counts(arm)
        begun_s = time.monotonic()
        for i in range(20_000):
            late = i % 17 == 0
            flood.send(ready[i % len(ready)], when[i % len(when)], 10**9 if late else 0)
            time.sleep(max(0.0, begun_s + i / 10_000 - time.monotonic()))
        arm.wait(for_s=0.2)
        taken, late, stale, refused = found = counts(arm) - before
        assert (found > 0).all() and late <= taken
        assert taken + stale + refused <= 20_000
        assert arm.mode == "active" and arm.faults == []
        passes_no_limit(standing, first)
        assert (np.array(standing.driver_status.commands_refused) == refused_before).all()
        good, wrong = flood.message(), flood.message("nan")
        for data, options, expected in (
            (good, {}, (1, 0, 0, 0)),
            (good, {"after_s": -0.3}, (0, 0, 1, 0)),
            (good, {"seq_before": 10**9}, (0, 0, 1, 0)),
            (good, {"after_s": 6.0}, (0, 0, 0, 1)),
            (wrong, {}, (0, 0, 0, 1)),
        ):
            before = counts(arm)
            flood.send(data, **options)
            arm.wait(until=lambda _, b=before: (counts(arm) != b).any(), timeout_s=5)
            arm.wait(for_s=0.05)
            assert tuple(counts(arm) - before) == expected, options
        flood.line.close()
