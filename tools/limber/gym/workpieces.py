"""workpiece_t from a task's values: what the tip touches with a shape."""

from typing import Any

import numpy as np

from limber.arrays import Floats
from limber.messages import message_class

STIFFNESS_N_PER_M, DAMPING_NS_PER_M = 2e4, 50.0


def hole(
    mouth: Floats,
    normal: Floats,
    peg: Floats,
    peg_radius_m: float,
    clearance_m: float,
    chamfer_m: float,
    depth_m: float,
    friction: float,
) -> Any:
    """A plate with a hole, `clearance_m` wider in radius than the peg. `peg`: its other end in tip
    axes; all else in base axes, m.
    """
    message = _workpiece("KIND_HOLE", mouth, normal, peg_radius_m, friction)
    message.peg = peg.tolist()
    message.radius_m = peg_radius_m + clearance_m
    message.chamfer_m, message.depth_m = chamfer_m, depth_m
    return message


def block(
    base: Floats,
    yaw: float,
    size: Floats,
    mass_kg: float,
    tip_radius_m: float,
    friction: float,
    table_friction: float,
) -> Any:
    """A block on a table whose normal is the z axis of the base."""
    message = _workpiece("KIND_BLOCK", base, np.array([0.0, 0.0, 1.0]), tip_radius_m, friction)
    message.yaw, message.size, message.mass_kg = yaw, size.tolist(), mass_kg
    message.table_friction = table_friction
    return message


def _workpiece(
    kind: str, point: Floats, normal: Floats, tip_radius_m: float, friction: float
) -> Any:
    message = message_class("workpiece_t")()
    message.kind = getattr(message, kind)
    message.point, message.normal = point.tolist(), normal.tolist()
    message.tip_radius_m, message.friction = tip_radius_m, friction
    message.stiffness_N_per_m, message.damping_Ns_per_m = STIFFNESS_N_PER_M, DAMPING_NS_PER_M
    return message
