"""Torque constant: the true torque of a motor over the value that its drive assumes.

From the balance of torques at the motor (`motor_side.py`) over slow motions up and down: kappa is
the slope of load over believed torque, friction is separated from it by the direction of motion.
"""

from collections import defaultdict

import numpy as np

from limber.identify.arm import Arm
from limber.identify.findings import AGAINST_URDF, Findings, Panel, Value
from limber.identify.motion import Motion
from limber.identify.motor_side import OFFSET, MotorSide, balance, loads
from limber.identify.regression import PoorLogError

WORST_STD = 0.05  # of kappa
LEAST_NM = 0.3  # by which the load has to change
APART, APART_SHARE = 3.0, 0.02  # standard errors, and share, by which joints may differ
KEY = "rotor_torque_constant_Nm_per_A"


def identify(arm: Arm, motion: Motion) -> Findings:
    found = Findings("torque constant")
    sides: dict[int, MotorSide] = {}
    all_loads = loads(arm, motion)
    for i, joint in enumerate(arm.joints):
        try:
            side = balance(arm, motion, all_loads, i)
            _require_load(side)
        except PoorLogError as reason:
            found.refused[joint.name] = str(reason)
            continue
        sides[i] = side
        found.panels.append(_panel(joint.name, side))
    for motor, indices in _by_motor(arm, sides).items():
        found.values += _values(arm, motor, {i: sides[i] for i in indices}, found)
    if sides:
        found.notes.append(
            "A drive that keeps a torque constant of its own turns N m into current by that one: "
            "correct it there as well."
        )
    if not all(motion.torque_sensor[i] for i in sides):
        found.notes.append(AGAINST_URDF)
    return found


def _require_load(side: MotorSide) -> None:
    span = float(np.ptp(side.load))
    cure = "move it where gravity pulls more, or hang a known weight on"
    if not span > LEAST_NM:
        raise PoorLogError(f"its load changes by only {span:.2g} N m; {cure}")
    if not side.kappa_std <= WORST_STD:
        raise PoorLogError(f"the result would be uncertain by {side.kappa_std:.0%}; {cure}")


def _by_motor(arm: Arm, sides: dict[int, MotorSide]) -> dict[str, list[int]]:
    groups = defaultdict(list)
    for i in sides:
        groups[arm.joints[i].motor].append(i)
    return groups


def _values(arm: Arm, motor: str, sides: dict[int, MotorSide], found: Findings) -> list[Value]:
    """One number for the motor model: the mean over its joints, weighted by their certainty."""
    kappas = np.array([side.kappa for side in sides.values()])
    stds = np.array([side.kappa_std for side in sides.values()])
    weights = stds**-2.0 / np.sum(stds**-2.0)
    mean = float(weights @ kappas)
    if np.any(np.abs(kappas - mean) > np.maximum(APART * stds, APART_SHARE)):
        found.notes.append(
            f"The joints with motor {motor} differ by more than their errors. Their mean is "
            "proposed; an entry in `motors` for each would keep them apart."
        )
    values = []
    for i, side in sides.items():
        joint = arm.joints[i]
        believed = float(joint.motor_values[KEY])
        now, std = believed * side.kappa, believed * side.kappa_std
        path = ("motors", motor, KEY)
        values.append(Value(joint.name, KEY, "N m/A", now, std, believed, path, believed * mean))
    return values


def _panel(name: str, side: MotorSide) -> Panel:
    without_friction = side.motor - side.friction(side.speed) / side.kappa
    ends = np.array([side.load.min(), side.load.max()])
    offset = side.fit.x[OFFSET]
    return Panel(
        name,
        "load at the joint (N m)",
        "believed motor torque\nless friction (N m)",
        side.load,
        without_friction,
        {
            f"measured: true/believed {side.kappa:.3f}": (ends, ends / side.kappa + offset),
            "as believed": (ends, ends + offset),
        },
    )
