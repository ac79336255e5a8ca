"""TARGET_STREAM and TORQUE_OVERLAY from a script's values."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from limber.arrays import Floats
from limber.errors import InputError
from limber.live.request_messages import LONGEST_S, six
from limber.live.values import number, numbers
from limber.messages import message_class

MOST_KNOTS = 16


def targets(joints: int, dt_s: Floats, given: dict[str, Any]) -> Iterator[Any]:
    """A message for each sixteen knots at `dt_s`, without t0_ns.

    `given`: joints_rad, or position_m with quaternion_wxyz, or twist, a row a knot;
    hand_width_m, one a knot or one for all; hand_force_N, stiffness_scale, force_N, torque_Nm,
    delay_s, valid_for_s.
    """
    kind, values = _values(joints, len(dt_s), given)
    width_m = given.pop("hand_width_m", None)
    if width_m is not None:
        width_m = numbers("hand_width_m", width_m, (len(dt_s),), one_for_all=True)
    common = _common(given)
    for first in range(0, len(dt_s), MOST_KNOTS):
        part = slice(first, min(first + MOST_KNOTS, len(dt_s)))
        message = message_class("target_stream_t")()
        message.kind = getattr(message, kind)
        message.num_joints = joints
        message.num_knots = part.stop - part.start
        message.dt_s[: message.num_knots] = dt_s[part].tolist()
        for row, value in zip(message.value, values[part].tolist(), strict=False):
            row[: len(value)] = value
        if width_m is not None:
            message.use_hand = 1
            message.hand_width_m[: message.num_knots] = width_m[part].tolist()
        for field, value in common.items():
            setattr(message, field, value)
        yield message


def overlay(joints: int, torque_Nm: ArrayLike, for_s: float) -> Any:
    message = message_class("torque_overlay_t")()
    message.num_joints = joints
    message.tau[:joints] = numbers("torque_Nm", torque_Nm, (joints,)).tolist()
    message.valid_for_s = number("for_s", for_s, 0.001, 0.05)
    return message


def _values(joints: int, knots: int, given: dict[str, Any]) -> tuple[str, Floats]:
    ways = [key for key in ("joints_rad", "position_m", "twist") if given.get(key) is not None]
    if len(ways) != 1:
        raise InputError("a target is one of: joints_rad, position_m with quaternion_wxyz, twist")
    taken = {key: given.pop(key, None) for key in ("joints_rad", "position_m", "twist")}
    turned = given.pop("quaternion_wxyz", None)
    if ways != ["position_m"]:
        if turned is not None:
            raise InputError("quaternion_wxyz goes with position_m")
        kind, columns = {"joints_rad": ("JOINTS", joints), "twist": ("TWIST", 6)}[ways[0]]
        return f"KIND_{kind}", numbers(ways[0], taken[ways[0]], (knots, columns))
    if turned is None:
        raise InputError("position_m and quaternion_wxyz belong together: give both")
    position = numbers("position_m", taken["position_m"], (knots, 3))
    quat = numbers("quaternion_wxyz", turned, (knots, 4))
    lengths = np.linalg.norm(quat, axis=1, keepdims=True)
    if (np.abs(lengths - 1.0) > 1e-3).any():
        raise InputError("quaternion_wxyz: expected unit quaternions")
    return "KIND_POSE", np.hstack((position, quat / lengths))


def _common(given: dict[str, Any]) -> dict[str, Any]:
    fields: dict[str, Any] = {
        "delay_s": number("delay_s", given.pop("delay_s", 0.0), 0.0, 2.0),
        "valid_for_s": number("valid_for_s", given.pop("valid_for_s", 0.0), 0.0, LONGEST_S),
        "hand_force_N": number("hand_force_N", given.pop("hand_force_N", 0.0), 0.0),
    }
    scale = given.pop("stiffness_scale", None)
    if scale is not None:
        fields["stiffness_scale"] = number("stiffness_scale", scale, 0.05, 1.0)
    wrench = {key: given.pop(key, None) for key in ("force_N", "torque_Nm")}
    fields["F_ff"] = six(wrench, "force_N", "torque_Nm")
    if given:
        raise InputError(f"{next(iter(given))!r} is no key of a target")
    return fields
