"""Torque constant: the true torque of a motor over the value that its drive assumes.

From the balance of torques at the motor (`motor_side.py`) over slow motions up and down: kappa is
the slope of load over believed torque, friction is separated from it by the direction of motion.
Without a torque sensor the load is what the URDF's links weigh: kappa is no better known than they.
"""

from collections import defaultdict
from dataclasses import replace

import numpy as np

from limber.identify.arm import Arm
from limber.identify.doubt import MASS_SHARE, Loads
from limber.identify.findings import AGAINST_URDF, Findings, Panel, Value
from limber.identify.motion import Motion
from limber.identify.motor_side import (
    COULOMB,
    KAPPA_HIGH,
    KAPPA_LOW,
    OFFSET,
    STRIBECK,
    VISCOUS,
    MotorSide,
    balance,
)
from limber.identify.regression import PoorLogError

WORST_STD = 0.05  # of kappa
SURE = 2.0  # standard errors; what is closer to robot.yaml's is the same
LEAST_NM = 0.3  # by which the load has to change
CONTRADICTED = 0.8  # of what is unexplained, if other weights are allowed
APART, APART_SHARE = 3.0, 0.02  # standard errors, and share, by which joints may differ
KEY = "rotor_torque_constant_Nm_per_A"


def identify(arm: Arm, motion: Motion, weights_share: float | None = None) -> Findings:
    """`weights_share`: how well the URDF's masses are known; None: as CAD usually is."""
    found = Findings("torque constant")
    sides: dict[int, MotorSide] = {}
    loads = Loads(arm, motion, weights_share or MASS_SHARE)
    for i, joint in enumerate(arm.joints):
        try:
            sides[i] = certain(loads, i)
        except PoorLogError as reason:
            found.refused[joint.name] = str(reason)
            continue
        found.panels.append(_panel(joint.name, sides[i]))
    for motor, indices in _by_motor(arm, sides).items():
        group = {i: sides[i] for i in indices}
        values = _values(arm, motor, group, found)
        if not _better(loads, group):
            found.notes.append(f"{motor}: robot.yaml's constant does as well; it stays.")
            values = [replace(value, path=None, proposed=None) for value in values]
        found.values += values
    if sides:
        found.notes.append(
            "A drive that keeps a torque constant of its own turns N m into current by that one: "
            "correct it there as well."
        )
    if not all(motion.torque_sensor[i] for i in sides):
        found.notes.append(AGAINST_URDF)
    return found


def certain(loads: Loads, i: int) -> MotorSide:
    """The balance of joint i, if its torque constant shows in it. Raises PoorLogError."""
    side = balance(loads, i)
    _require_load(loads, side, i)
    if not loads.motion.torque_sensor[i]:
        _require_right_weights(loads, side, i)
    _require_certainty(side)
    return side


def _better(loads: Loads, sides: dict[int, MotorSide]) -> bool:
    """Whether the joints with a motor show another constant than robot.yaml's, and leave less of
    held-out torques with it, the URDF as it is.
    """
    if not any(abs(side.kappa - 1.0) > SURE * side.kappa_std for side in sides.values()):
        return False
    pairs = [(_left(side), _left(balance(loads, i, known=True))) for i, side in sides.items()]
    return all(left < believed for left, believed in pairs)


def _left(side: MotorSide, errors: bool = False) -> float:
    """rms of held-out torques; `errors`: with what was found to be wrong with the model."""
    return float(np.std(side.unseen(COULOMB, VISCOUS, STRIBECK, errors=errors)))


def _require_load(loads: Loads, side: MotorSide, i: int) -> None:
    """Gravity or a sensor has to show it: inertias of a URDF are no scale."""
    cure = "move it where gravity pulls more, or hang a known weight on"
    rows = loads.motion.moving[:, i]
    if loads.motion.torque_sensor[i]:
        span = float(np.ptp(side.load))
        if not span > LEAST_NM:
            raise PoorLogError(f"its load changes by only {span:.2g} N m; {cure}")
        return
    span = float(np.ptp(loads.gravity[rows, i]))
    if not span > LEAST_NM:
        raise PoorLogError(
            f"gravity changes its load by only {span:.2g} N m, and the rest is inertia, of which "
            f"the URDF is no witness; {cure}"
        )


def _require_right_weights(loads: Loads, side: MotorSide, i: int) -> None:
    """Without a torque sensor, scale of the weights and constant are one: somebody has to vouch for
    the weights, and torques that other weights explain much better contradict him.
    """
    if loads.weights_share >= MASS_SHARE:
        raise PoorLogError(
            f"it has no torque sensor, and the URDF's weights are known to {MASS_SHARE:.0%} as of "
            "CAD: identify gravity first, or weigh the links and say how well they are known with "
            "--weights-known"
        )
    free = balance(Loads(loads.arm, loads.motion, MASS_SHARE), i)
    left, without = (_left(each, errors=True) for each in (free, side))
    if left < CONTRADICTED * without:
        raise PoorLogError(
            f"the URDF's weights leave {without:.3g} N m rms of held-out torques unexplained, "
            f"other weights {left:.3g}: identify gravity first"
        )


def _require_certainty(side: MotorSide) -> None:
    if np.isclose(side.kappa, (KAPPA_LOW, KAPPA_HIGH), rtol=1e-6).any():
        raise PoorLogError(
            f"its torque is not that of its load times {KAPPA_LOW:g} to {KAPPA_HIGH:g}: "
            "check sign and gear ratio, and identify gravity first"
        )
    if not side.kappa_std <= WORST_STD * min(side.kappa, 1.0):
        raise PoorLogError(
            f"the result would be uncertain by {side.kappa_std / side.kappa:.0%}; move it where "
            "gravity pulls more, or hang a known weight on"
        )


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
