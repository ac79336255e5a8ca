"""What an arm measures as ROS's messages; SI units on both sides."""

import numpy as np

from limber.live.arm_state import Pose, State
from limber.model.rotations import matrix_of
from limber.ros2 import ros_types as ros


def header(stamp_ns: int, frame: str = "") -> ros.Header:
    return ros.Header(ros.Time(*divmod(stamp_ns, 1_000_000_000)), frame)


def joint_state(state: State, joints: tuple[str, ...], stamp_ns: int) -> ros.JointState:
    """`effort`: the torques as measured."""
    position, velocity, effort = (x.tolist() for x in (state.q, state.v, state.tau))
    return ros.JointState(header(stamp_ns), list(joints), position, velocity, effort)


def tip_pose(pose: Pose, base: str, stamp_ns: int) -> ros.PoseStamped:
    w, x, y, z = pose.quat.tolist()
    found = ros.Pose(ros.Point(*pose.p.tolist()), ros.Quaternion(x, y, z, w))
    return ros.PoseStamped(header(stamp_ns, base), found)


def contact_wrench(state: State, tip: str, stamp_ns: int) -> ros.WrenchStamped:
    """The estimate of the world's wrench on the arm (F_ext) at the tip's origin, turned from base
    axes to the tip's: what a frame_id means in ROS. InputError without a contact source.
    """
    R_TB = matrix_of(state.pose.quat).T
    force, torque = (ros.Vector3(*(R_TB @ half).tolist()) for half in np.split(state.wrench, 2))
    return ros.WrenchStamped(header(stamp_ns, tip), ros.Wrench(force, torque))
