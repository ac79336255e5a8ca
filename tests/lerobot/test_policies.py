"""LeRobot's own loops with a policy that jumps and pauses: a synchronous rollout, and client and
server of asynchronous inference. The arm's motion is bounded, and goes on after each pause.
"""

import socket
import time
from itertools import islice

import numpy as np
import pytest
from commands import FOLLOWER, ended, environment, lerobot, stack

from limber.model.robot import load_robot
from limber.paths import ROOT

POLICIES = ROOT / "tests" / "lerobot" / "policies"
WRITE, SERVE = (
    f"import sys, lerobot_policy_jumps as jumps; jumps.{call}"
    for call in ("write(sys.argv[1], *map(float, sys.argv[2:]))", "serve()")
)
PORT = 8099
JUMPED = np.radians(20.0)  # joints 1 and 4, each at most 0.5 m from the tip
FASTEST = 2 * 0.5 * np.sqrt(25.0 * JUMPED)  # m/s, of a goal within 25 rad/s² (docs/policies.md)


@pytest.fixture
def plug_ins(tmp_path):
    """Where LeRobot finds the policy, as if it had been installed."""
    known = tmp_path / "plug_ins" / "lerobot_policy_jumps-1.dist-info"
    known.mkdir(parents=True)
    (known / "METADATA").write_text("Name: lerobot_policy_jumps\nVersion: 1\n", encoding="utf-8")
    return POLICIES, known.parent


class Seen:
    """What the arm did from the first target on."""

    def __init__(self, arm):
        self.arm, self.states = arm, []

    def look(self):
        found = list(islice(self.arm.states(hz=100), 20))
        self.states += found if self.arm.targets.taken else []

    def modes(self):
        return [state.mode for state in self.states]

    def check_motion(self):
        times = np.array([state.time_s for state in self.states])
        goals = np.array([state.goal.p for state in self.states])
        new = np.flatnonzero(np.diff(times) > 0.0)
        speeds = np.linalg.norm(np.diff(goals, axis=0)[new], axis=1) / np.diff(times)[new]
        assert 0.1 < speeds.max() < FASTEST
        limits = np.array([joint.velocity for joint in load_robot(self.arm.name).joints])
        velocity = np.abs([state.v for state in self.states]).max(axis=0)
        # Half of them for the goal, and a soft arm swings.
        assert (velocity < 0.65 * limits).all(), velocity
        q = np.array([state.q for state in self.states])[:, [0, 3]]
        assert (np.ptp(q, axis=0) > 0.7 * JUMPED).all() and (np.ptp(q, axis=0) < 2 * JUMPED).all()
        assert not self.arm.faults and self.arm.targets.refused == 0


def test_a_rollout(python, plug_ins, home, tmp_path):
    if not python.with_name("lerobot-rollout").exists():
        pytest.skip("LeRobot before 0.6 has no rollout")
    policy = tmp_path / "policy"
    lerobot(python, home, "-c", WRITE, policy, 0.0, 1.0, paths=plug_ins)
    with stack(tmp_path / "follower") as arm:
        seen = Seen(arm)
        words = ["lerobot-rollout", "--strategy.type=base", f"--policy.path={policy}"]
        words += [*FOLLOWER, "--task=jump", "--duration=12", "--play_sounds=false"]
        lerobot(python, home, *words, paths=plug_ins, meanwhile=seen.look)
        seen.check_motion()
        assert arm.targets.starved >= 3
        active = seen.modes()
        first, last = active.index("active"), len(active) - active[::-1].index("active")
        assert set(active[first:last]) == {"active"}
        assert arm.q[0] == pytest.approx(0.3, abs=0.05), "LeRobot takes it back at the end"


def test_asynchronous_inference(python, plug_ins, home, tmp_path):
    """One pause is longer than the arm waits: it is held, and goes on by itself."""
    policy = tmp_path / "policy"
    lerobot(python, home, "-c", WRITE, policy, 0.1, 0.1, 0.1, 6.0, paths=plug_ins)
    env = environment(home, *plug_ins)
    server = [python, "-c", SERVE, "--host=127.0.0.1", f"--port={PORT}"]
    client = [python, "-m", "lerobot.async_inference.robot_client", *FOLLOWER]
    client += ["--robot.silence_s=1", "--policy_type=jumps", f"--pretrained_name_or_path={policy}"]
    client += ["--actions_per_chunk=20", f"--server_address=127.0.0.1:{PORT}", "--task=jump"]
    with stack(tmp_path / "follower") as arm, ended(server, env=env, cwd=home):
        seen = Seen(arm)
        _await_server()
        told = tmp_path / "client.txt"
        with told.open("w") as file, ended(client, env=env, cwd=home, stdout=file, stderr=file):
            end = time.monotonic() + 200.0
            while not _went_on(seen.modes()):
                assert time.monotonic() < end, told.read_text()[-2000:]
                seen.look()
        seen.check_motion()


def _await_server():
    end = time.monotonic() + 120.0
    while True:
        try:
            socket.create_connection(("127.0.0.1", PORT)).close()
            return
        except OSError:
            assert time.monotonic() < end, "no policy server"
            time.sleep(0.5)


def _went_on(modes):
    """Active, held, and active for three seconds again."""
    return "hold" in modes and modes[modes.index("hold") :].count("active") > 300
