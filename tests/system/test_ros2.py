"""`limber export ros2` against the real processes and another participant of DDS. The same with
ROS's own rclpy: tests/ros2.
"""

import sys
from pathlib import Path

import pytest
import ros2_peer
from ros2_peer import until

from limber import Arm, StackLostError
from limber.lcmtypes.robot_info_t import robot_info_t
from limber.model.robot import load_robot

ROBOT = "planar2r"
PEER = Path(__file__).with_name("dds_peer.py")
# Of the peer: found by its port, as a node of ROS by Fast DDS is
CONFIG = "<Domain><Discovery><ParticipantIndex>auto</ParticipantIndex></Discovery></Domain>"


@pytest.fixture
def arm(stack, monkeypatch):
    """Active, and free for others."""
    monkeypatch.setenv("ROS_DOMAIN_ID", "77")
    monkeypatch.setenv("CYCLONEDDS_URI", CONFIG)
    if stack.pace != "--realtime":
        stack.robot = ROBOT
    stack.start_all()
    with ros2_peer.wait_for_stack(Arm) as found:
        found.activate()
        found.release()
        yield found


@pytest.fixture
def peer():
    with ros2_peer.peer(sys.executable, PEER, "77") as found:
        yield found


def test_nothing_is_taken_without_the_option(arm, peer, tmp_path):
    robot, told = load_robot(ROBOT), tmp_path / "told"
    with ros2_peer.bridge(told=told):
        ros2_peer.check_what_goes_out(peer, arm, robot)
        assert peer.subscribers("/limber/goal_pose") == peer.subscribers("/limber/stiffness") == 0
        assert "no --allow-commands" in peer.status("commands")["message"]
        ros2_peer.check_contact(peer, arm, robot)
    assert told.read_text(encoding="utf-8") == (
        f"{ROBOT} in ROS's domain 77 on lo. Ctrl-C ends it.\n"
    )


def test_commands_are_those_of_a_script(arm, peer, tmp_path):
    told = tmp_path / "told"
    with ros2_peer.bridge("--allow-commands", told=told):
        ros2_peer.check_commands(peer, arm, told)
    arm.activate()  # the lease is free again


def test_a_bridge_that_ends_leaves_the_arm_held(arm, peer, tmp_path):
    with ros2_peer.bridge("--allow-commands", told=tmp_path / "told"):
        until(lambda: peer.subscribers("/limber/stiffness") == 1, "the bridge")
        peer.send("/limber/stiffness", [150.0] * 3)
        until(lambda: ros2_peer.values(peer.status("commands"))["accepted"] == "1", "one accepted")
        assert arm.mode == "active"
    arm.wait(mode="hold")


@pytest.mark.realtime
def test_a_silent_driver_is_told_and_found_again(stack, arm, peer, tmp_path):
    with ros2_peer.bridge(told=tmp_path / "told"):
        peer.newest("/joint_states")
        stack.kill("driver")
        until(lambda: peer.status("arm")["level"] == 3, "STALE")
        assert "limber-driver has been silent" in peer.status("arm")["message"]
        silent = len(peer.heard["/joint_states"])
        stack.start("driver")
        until(lambda: len(peer.heard["/joint_states"]) > silent + 10, "joint states")
        until(lambda: peer.status("arm")["level"] < 3, "the arm's status")


def test_another_arms_stack_is_not_taken_for_this_one(stack, arm):
    other = robot_info_t()
    other.robot = "other"

    def told() -> bool:
        stack.user.lcm.publish("ROBOT_INFO", other.encode())
        try:
            return not arm.q.size
        except StackLostError as lost:
            return "now that of other, not planar2r" in str(lost)

    until(told, "another arm")
    until(lambda: _reads(arm), "this arm's next ROBOT_INFO")


def _reads(arm: Arm) -> bool:
    try:
        return bool(arm.q.size)
    except StackLostError:
        return False
