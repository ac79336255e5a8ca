"""Friction before and behind the transmission: Coulomb, viscous, breakaway where it shows.

Motor side: from the balance of torques at the motor (`motor_side.py`) in both directions. On
arms without torque sensors that is all friction of the joint. Link side: the sensed torque less
what the model of a free arm needs.
"""

import numpy as np

from limber.identify.arm import Arm, JointBelief
from limber.identify.findings import Findings, Panel, Value
from limber.identify.motion import Motion
from limber.identify.motor_side import (
    COULOMB,
    LOAD,
    OFFSET,
    STRIBECK,
    STRIBECK_SPEED,
    VISCOUS,
    MotorSide,
    balance,
    loads,
)
from limber.identify.regression import PoorLogError, fit, ratio

KAPPA_STD = 0.02  # below it the torque constant is measured along with friction
KAPPA_OFF = 0.03  # beyond it a note is added
SURE = 3.0  # standard errors
LEAST_LOAD = 0.1  # N m; less load does not determine the scale of the model
SECTION, LINK_SECTION = "friction", "link_friction"
COULOMB_KEY, VISCOUS_KEY = "coulomb_Nm", "viscous_Nms_per_rad"
STATIC_KEY, STRIBECK_KEY = "static_Nm", "stribeck_rad_per_s"


def identify(arm: Arm, motion: Motion) -> Findings:
    found = Findings("friction")
    all_loads = loads(arm, motion)
    model = arm.robot.dynamics.torque(motion.q, motion.v, motion.a)
    for i, joint in enumerate(arm.joints):
        try:
            side = _motor_side(arm, motion, all_loads, i)
        except PoorLogError as reason:
            found.refused[joint.name] = str(reason)
            continue
        if abs(side.kappa - 1.0) > KAPPA_OFF:
            found.notes.append(
                f"{joint.name}: its true motor torque is {side.kappa:.3f} of the drive's value; "
                "friction is given in true torque (identify torque-constant)."
            )
        found.values += _values(joint, side, bool(motion.torque_sensor[i]))
        found.panels.append(_panel(joint, side))
        if motion.torque_sensor[i]:
            found.values += _link_side(joint, motion, all_loads, model, i)
    return found


def _motor_side(arm: Arm, motion: Motion, all_loads: np.ndarray, i: int) -> MotorSide:
    """With the torque constant from the same log if it is certain, else that of robot.yaml."""
    try:
        side = balance(arm, motion, all_loads, i)
        if side.kappa_std <= KAPPA_STD:
            return side
    except PoorLogError:
        pass
    return balance(arm, motion, all_loads, i, known=True)


def _values(joint: JointBelief, side: MotorSide, sensor: bool) -> list[Value]:
    """Without a torque sensor both sides are measured together: what the link's is believed to be
    is taken off the proposal for the motor's.
    """
    found = [
        (COULOMB_KEY, "N m", *ratio(side.fit, (COULOMB,), LOAD)),
        (VISCOUS_KEY, "N m s/rad", *ratio(side.fit, (VISCOUS,), LOAD)),
    ]
    if side.stribeck_speed is not None:
        found.append((STATIC_KEY, "N m", *ratio(side.fit, (COULOMB, STRIBECK), LOAD)))
    elif (joint.believed(SECTION, joint.key(STATIC_KEY)) or np.inf) < found[0][2]:
        found.append((STATIC_KEY, *found[0][1:]))  # it cannot be less than Coulomb's
    values = []
    for rotary, unit, value, std in found:
        key = joint.key(rotary)
        beyond = 0.0 if sensor else joint.believed(LINK_SECTION, key) or 0.0
        values.append(_value(joint, SECTION, key, unit, value, std, max(value - beyond, 0.0)))
    if side.stribeck_speed is not None:
        key, speed = joint.key(STRIBECK_KEY), side.stribeck_speed
        std = float(side.fit.std[STRIBECK_SPEED])
        values.append(_value(joint, SECTION, key, "rad/s", speed, std, speed))
    return values


def _value(
    joint: JointBelief,
    section: str,
    key: str,
    unit: str,
    value: float,
    std: float,
    proposed: float,
) -> Value:
    path = ("joints", joint.name, section, key)
    believed = joint.believed(section, key)
    return Value(joint.name, f"{section}: {key}", unit, value, std, believed, path, proposed)


def _link_side(
    joint: JointBelief, motion: Motion, sensed: np.ndarray, model: np.ndarray, i: int
) -> list[Value]:
    """From tau = s model + F_c sign(v) + d v + o; nothing if it does not stand out."""
    rows = motion.moving[:, i]
    speed = motion.v[rows, i]
    A = np.stack([np.sign(speed), speed, model[rows, i], np.ones_like(speed)], axis=1)
    if not np.ptp(model[rows, i]) > LEAST_LOAD:
        A = np.delete(A, 2, axis=1)
    try:
        found = fit(A, sensed[rows, i], motion.block[rows])
    except PoorLogError:
        return []
    if not np.any(found.x[:2] > SURE * found.std[:2]):
        return []
    keys = ((COULOMB_KEY, "N m"), (VISCOUS_KEY, "N m s/rad"))
    return [
        _value(joint, LINK_SECTION, joint.key(key), unit, x, std, max(float(x), 0.0))
        for (key, unit), x, std in zip(keys, found.x, found.std, strict=False)
    ]


def _panel(joint: JointBelief, side: MotorSide) -> Panel:
    torque = side.kappa * (side.motor - side.fit.x[OFFSET]) - side.load
    speed = np.linspace(side.speed.min(), side.speed.max(), 400)
    lines = {"measured": (speed, side.friction(speed))}
    coulomb = joint.believed(SECTION, joint.key(COULOMB_KEY))
    viscous = joint.believed(SECTION, joint.key(VISCOUS_KEY))
    if coulomb is not None and viscous is not None:
        lines["robot.yaml"] = (speed, np.sign(speed) * coulomb + speed * viscous)
    unit = "m/s" if joint.prismatic else "rad/s"
    return Panel(joint.name, f"speed ({unit})", "friction (N m)", side.speed, torque, lines)
