"""The plug-in with LeRobot's own commands, and a hand: a dataset of limber's is replayed, a second
arm leads the first, and what is recorded then is read and replayed by LeRobot.
"""

import json
import subprocess
import sys
import time
from itertools import cycle

import numpy as np
import pytest
from commands import ARM, FOLLOWER, OTHER, lerobot, stack

from limber.model.robot import load_robot

OPEN_M = float(load_robot(ARM).hand.width_m.max())
LEADER = [
    "--teleop.type=limber_leader",
    f"--teleop.arm={ARM}",
    f"--teleop.url={OTHER['LCM_DEFAULT_URL']}",
]
HELD = """
import sys, threading, time
from lerobot_robot_limber import LimberFollower, LimberFollowerConfig
from limber import Arm

robot = LimberFollower(LimberFollowerConfig(arm=sys.argv[1], silence_s=0.5))
robot.connect()
action, arm = robot.get_observation(), robot._arm
robot.send_action(action)
arm.wait(mode="hold")
activate, may, longest_s = Arm.activate, threading.Event(), 0.0
Arm.activate = lambda arm: (may.wait(30), activate(arm))
begun_s = time.monotonic()
for _ in range(30):
    at_s = time.monotonic()
    robot.send_action(action)
    longest_s = max(longest_s, time.monotonic() - at_s)
    time.sleep(1 / 30)
assert time.monotonic() - begun_s < 25 and arm.mode == "hold"
taken = arm.targets.taken
may.set()
while arm.targets.taken < taken + 30:
    robot.send_action(action)
    time.sleep(1 / 30)
assert arm.mode == "active"
robot.disconnect()
print(f"{longest_s * 1e3:.2f} ms at most")
"""
FRAMES = """
import json, sys
from lerobot.datasets.lerobot_dataset import LeRobotDataset
found = LeRobotDataset(sys.argv[1], root=sys.argv[2])
frames = [found[i] for i in range(len(found))]
columns = {key: [frame[key].tolist() for frame in frames] for key in sys.argv[3:]}
print(json.dumps({"episodes": found.num_episodes, **columns}))
"""


def frames(python, home, name, root):
    """Episodes; observation.state and action, a row each frame."""
    columns = ("observation.state", "action")
    said = lerobot(python, home, "-c", FRAMES, name, root, *columns).splitlines()[-1]
    found = json.loads(said)
    return found["episodes"], *(np.array(found[column]) for column in columns)


@pytest.fixture
def made(tmp_path):
    """A dataset of limber's own: a joint moves along a stream, and the hand closes by half."""
    scenario = tmp_path / "moves.yaml"
    rest = "0.3, 0.3, 0, 1.4, 0, 0, 0"
    turned = "0.2, 0.3, 0, 1.4, 0, 0, 0"
    stream = f"{{dt_s: [0, 2], joints_rad: [[{rest}], [{turned}]], hand_width_m: {OPEN_M / 2}}}"
    scenario.write_text(
        f"format: limber-scenario/1\nrobot: {ARM}\nduration_s: 4\ntimeline:\n"
        "  - {at_s: 0.3, mode: hold}\n  - {at_s: 0.8, mode: active}\n"
        f"  - {{at_s: 1.0, stream: {stream}}}\n",
        encoding="utf-8",
    )
    limber = [sys.executable, "-m", "limber"]
    subprocess.run([*limber, "lab", scenario, "--out", tmp_path / "run"], check=True)
    out = tmp_path / "made"
    convert = [*limber, "log", "convert", tmp_path / "run", "--to", "lerobot", "--out", out]
    subprocess.run(convert, check=True)
    return out


def replay(python, home, name, root, **options):
    dataset = [f"--dataset.repo_id={name}", f"--dataset.root={root}", "--dataset.episode=0"]
    lerobot(python, home, "lerobot-replay", *FOLLOWER, "--play_sounds=false", *dataset, **options)


def test_replay(python, made, home, tmp_path):
    with stack(tmp_path / "follower") as arm:
        replay(python, home, "limber/made", made)
        # the last target, as far as gear friction lets a soft arm come
        assert arm.q[0] == pytest.approx(0.2, abs=0.05)
        assert arm.hand.state.width_m == pytest.approx(OPEN_M / 2, abs=2e-3)
        assert arm.targets.refused == 0 and arm.mode in ("active", "hold")


def test_teleoperate_record_and_replay_with_a_hand(python, home, tmp_path):
    recorded = tmp_path / "recorded"
    with stack(tmp_path / "follower") as arm, stack(tmp_path / "leader", **OTHER) as leader:
        leader.gains(law="gravity_compensation")
        leader.activate()
        widths, seen = cycle((0.25 * OPEN_M, 0.9 * OPEN_M)), []

        def squeeze():
            """As the fingers that lead it would."""
            leader.hand(width_m=next(widths))
            for _ in range(20):
                time.sleep(0.1)
                seen.append(arm.hand.state.width_m)

        lerobot(
            python,
            home,
            "lerobot-record",
            *FOLLOWER,
            *LEADER,
            "--play_sounds=false",
            "--dataset.repo_id=limber/recorded",
            f"--dataset.root={recorded}",
            "--dataset.push_to_hub=false",
            "--dataset.single_task=hold",
            "--dataset.num_episodes=2",
            "--dataset.episode_time_s=6",
            "--dataset.reset_time_s=1",
            meanwhile=squeeze,
        )
        assert min(seen) < 0.35 * OPEN_M and max(seen) > 0.8 * OPEN_M
        episodes, state, action = frames(python, home, "limber/recorded", recorded)
        assert (episodes, state.shape[1], action.shape[1]) == (2, 8, 8)
        # The follower has come to where the leader is: at home, in degrees.
        assert action[-1, 0] == pytest.approx(17.2, abs=1.0)
        assert state[-1, 0] == pytest.approx(17.2, abs=3.0)
        # The gripper, of 100: open and closed, and the observation a little behind the action.
        assert np.percentile(action[:, 7], [10, 90]) == pytest.approx([25, 90], abs=3)
        assert np.percentile(state[:, 7], [10, 90]) == pytest.approx([25, 90], abs=5)
        behind = [np.abs(state[k:, 7] - action[: len(action) - k, 7]).mean() for k in range(15)]
        assert 1 <= np.argmin(behind) <= 9 and min(behind) < 5

        seen.clear()
        arm.wait(for_s=0.1)
        replay(
            python,
            home,
            "limber/recorded",
            recorded,
            meanwhile=lambda: (time.sleep(0.02), seen.append(arm.hand.state.width_m)),
        )
        assert np.ptp(seen) == pytest.approx(0.65 * OPEN_M, abs=0.08 * OPEN_M)
        assert arm.targets.refused == 0


def test_an_action_does_not_wait_for_an_arm_that_is_held(python, home, tmp_path):
    """It has been silent; drives and law may take as long as they want."""
    with stack(tmp_path / "follower") as arm:
        print(lerobot(python, home, "-c", HELD, ARM))
        arm.wait(mode="hold")


def test_a_leader_opens_its_hand_softly(python, home, tmp_path):
    with stack(tmp_path / "follower"), stack(tmp_path / "leader", **OTHER) as leader:
        seen = set()

        def look():
            time.sleep(0.05)
            goal = leader.hand.state
            seen.add((leader.mode, leader.law, goal.goal_width_m, goal.goal_force_N))

        words = ["lerobot-teleoperate", *FOLLOWER, *LEADER, "--teleop_time_s=2"]
        lerobot(python, home, *words, meanwhile=look)
        assert ("active", "gravity_compensation", OPEN_M, 5.0) in seen
