"""An arm's quantities as ROS's messages: fields, frames, and the bytes on the wire."""

import struct

import numpy as np
import pytest
from made_logs import records

from limber import messages
from limber.errors import InputError
from limber.lcmtypes.joint_state_t import joint_state_t as Joints
from limber.live.arm_state import State
from limber.ros2 import diagnostics, to_ros
from limber.ros2 import ros_types as ros
from limber.ros2.from_ros import Outcomes

JOINTS = ("shoulder", "elbow")
STAMP_NS = 1_700_000_000_000_000_005
HALF = np.sqrt(0.5)
QUARTER_ABOUT_Z = [HALF, 0, 0, HALF]  # w, x, y, z: the tip's x axis lies along base y


def native(type_name: str, **fields) -> np.void:
    made = records(type_name, 1, num_joints=2, **fields)
    return made.astype(messages.native_dtype_of(type_name))[0]


def state(status: dict | None = None, **fields) -> State:
    given = {"mode": 4, "law": 2, "quat_BT": QUARTER_ABOUT_Z, **(status or {})}
    return State(native("joint_state_t", **fields), native("controller_status_t", **given), JOINTS)


def first_two(*values: float) -> np.ndarray:
    return np.array([*values, *[0] * (16 - len(values))])


def text(word: str) -> bytes:
    """CDR's string: its length with the final zero, then to the next multiple of four."""
    data = word.encode() + b"\0"
    return struct.pack("<I", len(data)) + data + bytes(-len(data) % 4)


def test_joint_states_are_these_bytes():
    """Little-endian CDR by hand: doubles stand at multiples of eight behind the first four."""
    now = state(q=first_two(0.5, -1.0), v=first_two(2.0, 3.0), tau=first_two(-4.0, 5.0))
    head = struct.pack("<iI", 1_700_000_000, 5) + text("") + struct.pack("<I", 2)
    names = text("shoulder") + text("elbow")
    body = head + names
    for pair in ((0.5, -1.0), (2.0, 3.0), (-4.0, 5.0)):
        body += struct.pack("<I", 2)
        body += bytes(-len(body) % 8) + struct.pack("<2d", *pair)
    assert to_ros.joint_state(now, JOINTS, STAMP_NS).serialize() == b"\0\1\0\0" + body


def test_names_are_those_of_ros_over_dds():
    assert ros.JointState.__idl__.idl_transformed_typename == "sensor_msgs::msg::dds_::JointState_"
    assert ros.Time.__idl__.idl_transformed_typename == "builtin_interfaces::msg::dds_::Time_"


def test_the_scalar_of_a_quaternion_is_last():
    now = state({"p_BT": [1, 2, 3], "quat_BT": [0.1, 0.2, 0.3, 0.4]})
    found = to_ros.tip_pose(now.pose, "base", STAMP_NS)
    assert found.header.frame_id == "base"
    assert (found.header.stamp.sec, found.header.stamp.nanosec) == (1_700_000_000, 5)
    p, Q = found.pose.position, found.pose.orientation
    assert (p.x, p.y, p.z) == (1, 2, 3)
    assert (Q.x, Q.y, Q.z, Q.w) == (0.2, 0.3, 0.4, 0.1)


def test_contact_is_in_the_axes_of_its_frame():
    """The tip is turned by a quarter about z: base x is its -y, base y its x."""
    now = state({"contact": 2, "F_ext": [1.0, 2, 3, 4, 5, 6]})
    found = to_ros.contact_wrench(now, "tip", STAMP_NS)
    assert found.header.frame_id == "tip"
    force, torque = found.wrench.force, found.wrench.torque
    assert (force.x, force.y, force.z) == pytest.approx((2, -1, 3))
    assert (torque.x, torque.y, torque.z) == pytest.approx((5, -4, 6))
    with pytest.raises(InputError, match="no contact source"):
        to_ros.contact_wrench(state(), "tip", STAMP_NS)


def values(status) -> dict[str, str]:
    return {pair.key: pair.value for pair in status.values}


def test_a_fault_has_its_words():
    now = state({"mode": 6, "reason": 3, "reason_joint": -1}, fault=4, fault_joint=1)
    found = diagnostics.arm_status(now, "planar2r")
    assert (found.level, found.name, found.hardware_id) == (ros.ERROR, "limber: arm", "planar2r")
    assert "driver.DRIVE_ERROR (elbow): " in found.message and "To do: " in found.message
    assert values(found)["fault 2"].startswith("driver.DRIVE_ERROR (elbow)")
    assert values(found)["mode"] == "fault" and found.message.startswith("fault ")


def test_a_limit_that_acts_is_a_warning_a_ramp_is_none():
    limits = {"LIMIT_TORQUE": 1, "LIMIT_RAMP": 32}
    torque = diagnostics.arm_status(state({"limits": sum(limits.values())}), "arm")
    assert torque.level == ros.WARN and torque.message == "active limits act: TORQUE"
    ramp = diagnostics.arm_status(state({"limits": 32}), "arm")
    assert (ramp.level, ramp.message) == (ros.OK, "active")
    assert values(ramp)["contact_wrench"] == "none"


def test_drives_one_by_one():
    flags = first_two(Joints.JOINT_ENABLED, Joints.JOINT_DRIVE_ERROR | Joints.JOINT_WARNING)
    now = state(joint_flags=flags, temperature_degC=first_two(41.5), drive_status=first_two(1, 12))
    shoulder, elbow = diagnostics.joint_statuses(now, JOINTS, "arm")
    assert (shoulder.level, shoulder.name, shoulder.message) == (
        ros.OK,
        "limber: joint shoulder",
        "ok",
    )
    assert values(shoulder)["temperature_degC"] == "41.5" and values(shoulder)["enabled"] == "true"
    assert elbow.level == ros.ERROR and elbow.message.startswith("The drive of the joint reports")
    assert values(elbow)["problems"] == "joint.DRIVE_ERROR, joint.WARNING"
    assert values(elbow)["drive_status"] == "12"
    assert "temperature_degC" not in values(elbow), "its drive reports none"


def test_the_hand_comes_after_the_joints():
    flags = first_two(1, 1, Joints.JOINT_HAND | Joints.JOINT_WARNING)
    *_, hand = diagnostics.joint_statuses(state(joint_flags=flags), JOINTS, "arm")
    assert (hand.name, hand.level) == ("limber: joint hand", ros.WARN)


def test_commands():
    none = diagnostics.command_status(None, "arm")
    assert (none.level, none.message) == (ros.OK, "none are taken: no --allow-commands")
    refused = diagnostics.command_status(Outcomes(3, 1, "goal_pose: no", "goal_pose: no"), "arm")
    assert (refused.level, refused.message) == (ros.WARN, "goal_pose: no")
    since = diagnostics.command_status(Outcomes(4, 1, "", "goal_pose: no"), "arm")
    assert (since.level, since.message) == (ros.OK, "ok")
    assert values(since) == {"accepted": "4", "refused": "1", "last refusal": "goal_pose: no"}
