"""What comes from ROS is checked before it becomes a request."""

import warnings

import numpy as np
import pytest

from limber.errors import InputError
from limber.live.arm_errors import RefusedError
from limber.ros2 import ros_types as ros
from limber.ros2.from_ros import Requests, goal_of, stiffness_of

NAN, INFINITE = float("nan"), float("inf")
UPRIGHT = (0.0, 0.0, 0.0, 1.0)


def goal(frame: str = "base", at=(0.1, 0.2, 0.3), turned=UPRIGHT):
    pose = ros.Pose(ros.Point(*at), ros.Quaternion(*turned))
    return ros.PoseStamped(ros.Header(ros.Time(0, 0), frame), pose)


def numbers(*data: float, sizes=(), offset: int = 0):
    dimensions = [ros.MultiArrayDimension("", size, size) for size in sizes]
    return ros.Float64MultiArray(ros.MultiArrayLayout(dimensions, offset), list(data))


def test_a_pose_is_a_goal_with_the_scalar_first():
    found = goal_of(goal(turned=(0.6, 0.0, 0.0, 0.8)), "base")
    np.testing.assert_array_equal(found["position_m"], [0.1, 0.2, 0.3])
    np.testing.assert_allclose(found["quaternion_wxyz"], [0.8, 0.6, 0, 0], atol=1e-15)


@pytest.mark.parametrize(
    ("message", "words"),
    [
        (goal("map"), "frame_id is 'map'; expected 'base', the arm's base"),
        (goal(""), "frame_id is ''; expected 'base'"),
        (goal(at=(0.1, NAN, 0.3)), "position: .* is not finite"),
        (goal(at=(0.1, INFINITE, 0.3)), "position: .* is not finite"),
        (goal(turned=(0.0, 0.0, NAN, 1.0)), "orientation: .* is not finite"),
        (goal(turned=(0.0, 0.0, 0.0, 0.0)), "orientation: has length 0; expected 1"),
        (goal(turned=(0.0, 0.0, 0.0, 1.1)), "orientation: has length 1.1; expected 1"),
    ],
)
def test_a_pose_that_is_no_goal(message, words):
    with pytest.raises(InputError, match=words):
        goal_of(message, "base")


def test_three_or_six_numbers_are_a_stiffness():
    three = stiffness_of(numbers(100, 200, 300, sizes=(3,)))
    assert {key: value.tolist() for key, value in three.items()} == {
        "K_x_translation_N_per_m": [100, 200, 300]
    }
    six = stiffness_of(numbers(1, 2, 3, 4, 5, 6, sizes=(2, 3)))
    assert six["K_x_translation_N_per_m"].tolist() == [1, 2, 3]
    assert six["K_x_rotation_Nm_per_rad"].tolist() == [4, 5, 6]


@pytest.mark.parametrize(
    ("message", "words"),
    [
        (numbers(), "expected 3 numbers, N/m, or 6, .* got 0"),
        (numbers(100), "got 1"),
        (numbers(1, 2, 3, 4, 5, 6, 7), "got 7"),
        (numbers(1, NAN, 3), "data: .* is not finite"),
        (numbers(1, 2, 3, sizes=(4,)), "the layout is not that of 3 numbers"),
        (numbers(1, 2, 3, offset=1), "the layout is not that of 3 numbers"),
    ],
)
def test_numbers_that_are_no_stiffness(message, words):
    with pytest.raises(InputError, match=words):
        stiffness_of(message)


class Arm:
    """Refuses what is `refused`, and takes the rest with a doubt."""

    def __init__(self, refused: bool) -> None:
        self.refused, self.asked = refused, []

    def set_goal(self, **keys):
        if self.refused:
            raise RefusedError("request.MODE", "goal is not taken in HOLD", "active")
        warnings.warn("taken, but: far away", stacklevel=1)
        self.asked.append(("goal", keys))

    def gains(self, law, ramp_s, **keys):
        self.asked.append(("gains", law, ramp_s, keys))


def test_requests_are_those_of_a_script():
    told, arm = [], Arm(refused=False)
    requests = Requests(arm, "base", told.append)
    requests.goal(goal())
    requests.stiffness(numbers(1, 2, 3))
    (what, keys), (gains, law, ramp_s, given) = arm.asked
    assert (what, keys["position_m"].tolist(), keys["duration_s"]) == ("goal", [0.1, 0.2, 0.3], 0)
    assert (gains, law, ramp_s) == ("gains", None, 0.5) and len(given) == 1
    assert (requests.outcomes.accepted, requests.outcomes.refusal) == (2, "")
    assert told == ["goal_pose: taken, but: far away"]


def test_refusals_are_told_and_counted():
    told, arm = [], Arm(refused=True)
    requests = Requests(arm, "base", told.append)
    for _ in range(3):  # of a stream of them, one line a second
        requests.goal(goal())
    requests.goal(goal("map"))
    requests.unreadable("limber/stiffness", ValueError("cut"))
    assert told == [
        "goal_pose: refused: request.MODE: goal is not taken in HOLD; to do: active",
        "goal_pose: frame_id is 'map'; expected 'base', the arm's base",
        "limber/stiffness: cannot be read: cut",
    ]
    found = requests.outcomes
    assert (found.accepted, found.refused, found.refusal) == (0, 5, told[-1])
    requests.stiffness(numbers(1, 2, 3))
    assert (requests.outcomes.refusal, requests.outcomes.last_refusal) == ("", told[-1])
