"""`limber export ros2` and ROS 2 itself: rclpy of Jazzy with Fast DDS, from wheels (0.25 GB).

`./limber test ros2` makes the environment in build/ros2, with Python 3.12 or uv, or takes the
Python that LIMBER_ROS2 names. Then the rest runs in a network namespace of its own.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest
import ros2_peer
from other_python import make_environment
from own_network import leave_the_machines_network
from processes import started
from ros2_peer import until

from limber import Arm
from limber.model.robot import load_robot
from limber.paths import ROOT

ROBOT = "planar2r"
PEER = Path(__file__).with_name("rclpy_peer.py")
PACKAGES = ("rclpy", "sensor-msgs", "geometry-msgs", "diagnostic-msgs", "std-msgs")
WHEELS = [f"ros-jazzy-{name}" for name in (*PACKAGES, "rmw-fastrtps-cpp")]
SCENARIO = f"""format: limber-scenario/1
robot: {ROBOT}
duration_s: 3600
mode: realtime
friction: false
timeline:
  - {{at_s: 0.3, mode: hold}}
  - {{at_s: 0.8, mode: active}}
  - {{at_s: 1.0, mode: release}}
"""


@pytest.fixture(scope="module")
def installed():
    if "LIMBER_ROS2" in os.environ:
        return Path(os.environ["LIMBER_ROS2"])
    folder = ROOT / "build" / "ros2"
    found = folder / "bin" / "python"
    if not found.exists() and not make_environment(folder, "3.12"):
        pytest.fail("needs Python 3.12 (python3.12 or uv), or LIMBER_ROS2=PYTHON")
    subprocess.run([found, "-m", "pip", "install", "-q", *WHEELS], check=True)
    return found


@pytest.fixture(scope="module")
def python(installed):
    """ROS's; this process has left the machine's network."""
    leave_the_machines_network()
    return installed


@pytest.fixture
def arm(python, tmp_path):
    scenario = tmp_path / "waits.yaml"
    scenario.write_text(SCENARIO, encoding="utf-8")
    run = [sys.executable, "-m", "limber", "run", scenario, "--one-process", "--no-record"]
    with started([*run, "--out", tmp_path / "run"]) as process:
        with ros2_peer.wait_for_stack(Arm) as found:
            found.wait(mode="active")
            yield found
        process.terminate()


@pytest.fixture
def peer(python, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", "77")
    with ros2_peer.peer(python, PEER) as found:
        yield found


def test_nothing_is_taken_without_the_option(arm, peer, tmp_path):
    robot = load_robot(ROBOT)
    with ros2_peer.bridge(told=tmp_path / "told"):
        ros2_peer.check_what_goes_out(peer, arm, robot)
        peer.send("?", "topics")
        until(lambda: peer.heard["?"], "topics")
        topics = peer.heard["?"][-1]
        assert "/joint_states sensor_msgs/msg/JointState" in topics
        assert "/limber/contact_wrench geometry_msgs/msg/WrenchStamped" in topics
        assert peer.subscribers("/limber/goal_pose") == peer.subscribers("/limber/stiffness") == 0
        ros2_peer.check_contact(peer, arm, robot)


def test_commands_are_those_of_a_script(arm, peer, tmp_path):
    told = tmp_path / "told"
    with ros2_peer.bridge("--allow-commands", told=told):
        ros2_peer.check_commands(peer, arm, told)
