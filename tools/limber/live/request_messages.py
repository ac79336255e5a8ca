"""Goals, pushes, walls and payloads as messages; keys and units as in a scenario's timeline."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from limber.errors import InputError
from limber.live.meant import LENGTHS, check_lengths
from limber.live.values import number, numbers, unit
from limber.messages import message_class

LONGEST_S = 600.0
_WAYS = {
    "GOAL_OFFSET": ("offset_m", "offset_rad"),
    "GOAL_POSE": ("position_m", "quaternion_wxyz"),
    "GOAL_JOINT": ("joints_rad",),
    "GOAL_CIRCLE": ("circle_centre_m", "circle_axis"),
}
SHORTEST_PUSH_S = 1e-3
_MORE = ("force_N", "torque_Nm", "posture_rad", "duration_s", "valid_for_s")


def goal(joints: int, **given: Any) -> Any:
    """A compliance_goal_t for an arm of so many joints; what is None counts as not given.

    One of offset_m and offset_rad; position_m with quaternion_wxyz; joints_rad; circle_centre_m
    with circle_axis; or none of them, for force_N and torque_Nm alone. Whether the arm may have
    the goal is the controller's to decide.
    """
    given = {key: value for key, value in given.items() if value is not None}
    known = [key for keys in _WAYS.values() for key in keys] + list(_MORE)
    if unknown := [key for key in given if key not in known]:
        raise InputError(f"a goal has no {unknown[0]}; expected: {', '.join(known)}")
    check_lengths({key: np.ravel(given[key]).tolist() for key in LENGTHS if key in given})
    ways = [kind for kind, keys in _WAYS.items() if any(key in given for key in keys)]
    if len(ways) > 1 or not (ways or {"force_N", "torque_Nm"} & given.keys()):
        raise InputError(
            "a goal is one of: offset_m with offset_rad, position_m with quaternion_wxyz, "
            "joints_rad, circle_centre_m with circle_axis, or force_N with torque_Nm"
        )
    message = message_class("compliance_goal_t")()
    message.kind = getattr(message, ways[0] if ways else "GOAL_WRENCH")
    message.num_joints = joints
    message.duration_s = number("duration_s", given.get("duration_s", 0.0), 0.0, LONGEST_S)
    message.valid_for_s = number("valid_for_s", given.get("valid_for_s", 0.0), 0.0, LONGEST_S)
    message.quat_BD = [1.0, 0.0, 0.0, 0.0]
    if "GOAL_OFFSET" in ways:
        message.offset = six(given, "offset_m", "offset_rad")
    if "GOAL_POSE" in ways:
        _both(given, "position_m", "quaternion_wxyz")
        message.p_BD = numbers("position_m", given["position_m"], (3,)).tolist()
        message.quat_BD = unit("quaternion_wxyz", given["quaternion_wxyz"], 4).tolist()
    if "GOAL_CIRCLE" in ways:
        _both(given, "circle_centre_m", "circle_axis")
        centre = numbers("circle_centre_m", given["circle_centre_m"], (3,))
        message.offset = [*centre.tolist(), *unit("circle_axis", given["circle_axis"], 3).tolist()]
    posture = "joints_rad" if "GOAL_JOINT" in ways else "posture_rad"
    if posture in given:
        message.q[:joints] = numbers(posture, given[posture], (joints,)).tolist()
        message.use_posture = int(posture == "posture_rad")
    message.F_ff = six(given, "force_N", "torque_Nm")
    return message


def push(
    force_N: ArrayLike | None,
    torque_Nm: ArrayLike | None,
    for_s: float,
    ramp_s: float,
    link: str,
    number_: int,
) -> Any:
    if force_N is None and torque_Nm is None:
        raise InputError("a push needs force_N or torque_Nm, three numbers in base axes")
    message = message_class("push_t")()
    message.id = number_
    message.link = link
    message.wrench = six({"force_N": force_N, "torque_Nm": torque_Nm}, "force_N", "torque_Nm")
    message.duration_s = number("for_s", for_s, SHORTEST_PUSH_S, 60.0)
    message.ramp_s = number("ramp_s", ramp_s, 0.0, 0.5 * message.duration_s)
    return message


def wall(
    point_m: ArrayLike, normal: ArrayLike, stiffness_N_per_m: float, damping_Ns_per_m: float
) -> Any:
    message = _event("EVENT_WALL")
    message.point = numbers("point_m", point_m, (3,)).tolist()
    message.normal = unit("normal", normal, 3).tolist()
    message.stiffness_N_per_m = number("stiffness_N_per_m", stiffness_N_per_m, 1.0, 1e7)
    message.damping_Ns_per_m = number("damping_Ns_per_m", damping_Ns_per_m, 0.0, 1e5)
    return message


def no_wall() -> Any:
    return _event("EVENT_WALL")


def payload(mass_kg: float, position_m: ArrayLike) -> Any:
    message = _event("EVENT_PAYLOAD")
    message.payload_mass_kg = number("mass_kg", mass_kg, 0.0, 100.0)
    message.payload_position = numbers("position_m", position_m, (3,)).tolist()
    return message


def _event(kind: str) -> Any:
    message = message_class("scenario_event_t")()
    message.kind = getattr(message, kind)
    message.normal = [0.0, 0.0, 1.0]
    return message


def six(given: dict[str, Any], linear: str, angular: str) -> list[float]:
    """Both halves of a six-vector; zero where one is not given."""
    halves = [given.get(key) for key in (linear, angular)]
    return [
        x
        for key, half in zip((linear, angular), halves, strict=True)
        for x in ([0.0] * 3 if half is None else numbers(key, half, (3,)).tolist())
    ]


def _both(given: dict[str, Any], first: str, second: str) -> None:
    if not {first, second} <= given.keys():
        raise InputError(f"{first} and {second} belong together: give both")
