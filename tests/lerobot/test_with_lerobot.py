"""The plug-in with LeRobot itself, in an environment of its own (5 GB): a dataset of limber's is
replayed, a second arm leads the first, and what is recorded then is read by LeRobot.

`./limber test lerobot` makes the environment in build/lerobot, or takes the Python that
LIMBER_LEROBOT names. Then the rest runs in a network namespace of its own.
"""

import os
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pytest
from own_network import leave_the_machines_network
from processes import started

from limber import Arm, NoStackError
from limber.paths import ROOT

OTHER = {
    "LCM_DEFAULT_URL": "udpm://239.255.76.67:7669?ttl=0",
    "LIMBER_ARM_URL": "udpm://239.255.76.68:7670?ttl=0",
}
# The newest that this Python can have
LEROBOT = "lerobot[dataset]==0.6.1" if sys.version_info >= (3, 12) else "lerobot==0.4.4"
FOLLOWER = ["--robot.type=limber_follower", "--play_sounds=false"]
LEADER = ["--teleop.type=limber_leader", f"--teleop.url={OTHER['LCM_DEFAULT_URL']}"]
LOADED = """
import sys
from lerobot.datasets.lerobot_dataset import LeRobotDataset
found = LeRobotDataset(sys.argv[1], root=sys.argv[2])
frame = found[len(found) - 1]
print(found.num_episodes, *frame["observation.state"].tolist(), "|", *frame["action"].tolist())
"""


@pytest.fixture(scope="module")
def python(installed):
    """LeRobot's; this process has left the machine's network."""
    leave_the_machines_network()
    return installed


@pytest.fixture(scope="module")
def installed():
    if "LIMBER_LEROBOT" in os.environ:
        return Path(os.environ["LIMBER_LEROBOT"])
    folder = ROOT / "build" / "lerobot"
    found = folder / "bin" / "python"
    if not found.exists():
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
        subprocess.run([found, "-m", "pip", "install", "-q", LEROBOT], check=True)
    plug_in = ROOT / "integrations" / "lerobot"
    subprocess.run([found, "-m", "pip", "install", "-q", "--no-deps", "-e", plug_in], check=True)
    return found


@contextmanager
def stack(folder, **address):
    run = [sys.executable, "-m", "limber", "run", ROOT / "scenarios" / "ready.yaml"]
    run += ["--one-process", "--no-record", "--out", folder]
    with started(run, env={**os.environ, **address}):
        yield


def wait_until_ready(url=None):
    for _ in range(60):
        try:
            with Arm(url=url) as arm:
                arm.wait(until=lambda now: now.mode in ("hold", "active"), timeout_s=60)
                return
        except NoStackError:
            time.sleep(1.0)
    raise AssertionError("no stack")


def lerobot(python, home, command, *options):
    env = {**os.environ, "HF_HUB_OFFLINE": "1", "HF_LEROBOT_HOME": str(home)}
    env["PYTHONPATH"] = str(ROOT / "tools")
    program = [python.with_name(command), *options] if command else [python, *options]
    done = subprocess.run(program, env=env, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout


def numbers(python, home, name, root):
    """Episodes; observation.state and action of the last frame."""
    state, action = lerobot(python, home, "", "-c", LOADED, name, str(root)).split("|")
    episodes, *values = (float(word) for word in state.split())
    return int(episodes), values, [float(word) for word in action.split()]


@pytest.fixture
def made(tmp_path):
    """A dataset of limber's own: a joint that moves along a stream."""
    scenario = tmp_path / "moves.yaml"
    rest = "0.3, 0.3, 0, 1.4, 0, 0, 0"
    turned = "0.2, 0.3, 0, 1.4, 0, 0, 0"
    scenario.write_text(
        "format: limber-scenario/1\nrobot: openarm\nduration_s: 4\ntimeline:\n"
        "  - {at_s: 0.3, mode: hold}\n  - {at_s: 0.8, mode: active}\n"
        f"  - {{at_s: 1.0, stream: {{dt_s: [0, 2], joints_rad: [[{rest}], [{turned}]]}}}}\n",
        encoding="utf-8",
    )
    limber = [sys.executable, "-m", "limber"]
    subprocess.run([*limber, "lab", scenario, "--out", tmp_path / "run"], check=True)
    out = tmp_path / "made"
    convert = [*limber, "log", "convert", tmp_path / "run", "--to", "lerobot", "--out", out]
    subprocess.run(convert, check=True)
    return out


def test_replay_teleoperate_record(python, made, tmp_path):
    home, recorded = tmp_path / "home", tmp_path / "recorded"
    with stack(tmp_path / "follower"), stack(tmp_path / "leader", **OTHER):
        wait_until_ready()
        wait_until_ready(OTHER["LCM_DEFAULT_URL"])
        dataset = ["--dataset.repo_id=limber/made", f"--dataset.root={made}"]
        lerobot(python, home, "lerobot-replay", *FOLLOWER, *dataset, "--dataset.episode=0")
        with Arm() as arm:  # the last target, as far as gear friction lets a soft arm come
            assert arm.q[0] == pytest.approx(0.2, abs=0.05)
            assert arm.targets.refused == 0 and arm.mode in ("active", "hold")
        lerobot(
            python,
            home,
            "lerobot-record",
            *FOLLOWER,
            *LEADER,
            "--dataset.repo_id=limber/recorded",
            f"--dataset.root={recorded}",
            "--dataset.push_to_hub=false",
            "--dataset.single_task=hold",
            "--dataset.num_episodes=2",
            "--dataset.episode_time_s=3",
            "--dataset.reset_time_s=1",
        )
        with Arm() as arm:
            assert arm.targets.refused == 0
    episodes, state, action = numbers(python, home, "limber/recorded", recorded)
    assert (episodes, len(state), len(action)) == (2, 21, 7)
    # The follower has come to where the leader is: at home, in degrees.
    assert action[0] == pytest.approx(17.2, abs=1.0) and state[0] == pytest.approx(17.2, abs=3.0)
