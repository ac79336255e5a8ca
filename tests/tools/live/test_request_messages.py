"""Requests from a script: right as a message, or wrong with the reason."""

import numpy as np
import pytest

from limber.errors import InputError
from limber.live import request_messages
from limber.messages import decode

GOAL = request_messages.goal


def encoded(message):
    return decode(type(message).__name__, message.encode())


def test_kinds_of_goals():
    offset = encoded(GOAL(2, offset_m=[0.1, 0, 0], duration_s=2))
    assert (offset.kind, offset.num_joints, offset.duration_s) == (offset.GOAL_OFFSET, 2, 2.0)
    assert list(offset.offset) == [0.1, 0, 0, 0, 0, 0]
    pose = encoded(GOAL(2, position_m=np.ones(3), quaternion_wxyz=(0.70711, 0, 0, 0.70711)))
    assert pose.kind == pose.GOAL_POSE
    assert np.linalg.norm(pose.quat_BD) == pytest.approx(1.0, abs=1e-15)
    joints = encoded(GOAL(2, joints_rad=[0.1, 0.2]))
    assert joints.kind == joints.GOAL_JOINT and list(joints.q[:3]) == [0.1, 0.2, 0.0]
    assert joints.use_posture == 0
    wrench = encoded(GOAL(2, force_N=[1, 2, 3]))
    assert wrench.kind == wrench.GOAL_WRENCH and list(wrench.F_ff) == [1, 2, 3, 0, 0, 0]
    circle = encoded(GOAL(2, circle_centre_m=[0.1, 0, 0], circle_axis=[0, 0, 1], duration_s=3))
    assert circle.kind == circle.GOAL_CIRCLE and list(circle.offset) == [0.1, 0, 0, 0, 0, 1]
    posture = encoded(GOAL(2, offset_m=[0, 0, 0], posture_rad=[0.3, 0.4]))
    assert posture.use_posture == 1 and list(posture.q[:2]) == [0.3, 0.4]


@pytest.mark.parametrize(
    ("keys", "reason"),
    [
        ({}, "a goal is one of"),
        ({"duration_s": 1}, "a goal is one of"),
        ({"offset": [0, 0, 0]}, "a goal has no offset; expected: offset_m"),
        ({"offset_m": [0, 0, 0], "joints_rad": [0, 0]}, "a goal is one of"),
        ({"offset_m": [0, 0]}, "offset_m: expected 3 numbers"),
        ({"offset_m": [0, 0, np.nan]}, "not finite"),
        ({"offset_m": "up"}, "no number or array"),
        ({"joints_rad": [0, 0, 0]}, "joints_rad: expected 2 numbers"),
        ({"position_m": [0, 0, 0]}, "belong together"),
        ({"position_m": [0, 0, 0], "quaternion_wxyz": [1, 1, 0, 0]}, "has length 1.41"),
        ({"force_N": [0, 0, 0], "duration_s": -1}, "duration_s: -1 is out of range"),
        ({"force_N": [0, 0, 0], "duration_s": np.nan}, "not finite"),
    ],
)
def test_wrong_goals(keys, reason):
    with pytest.raises(InputError, match=reason):
        GOAL(2, **keys)


def test_pushes_and_walls():
    push = encoded(request_messages.push([0, 9, 0], None, 2.0, 0.5, "", 3))
    assert list(push.wrench) == [0, 9, 0, 0, 0, 0] and push.id == 3
    wall = encoded(request_messages.wall([0, 0, 0.1], [0, 0, 1], 5000, 10))
    assert wall.kind == wall.EVENT_WALL and wall.stiffness_N_per_m == 5000
    assert encoded(request_messages.no_wall()).stiffness_N_per_m == 0
    with pytest.raises(InputError, match="needs force_N or torque_Nm"):
        request_messages.push(None, None, 1.0, 0.0, "", 1)
    with pytest.raises(InputError, match=r"ramp_s: 0\.6 is out of range"):
        request_messages.push([0, 9, 0], None, 1.0, 0.6, "", 1)
    with pytest.raises(InputError, match="normal: has length 2"):
        request_messages.wall([0, 0, 0], [0, 0, 2], 5000, 10)
