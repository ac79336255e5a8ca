"""Friction before and behind the transmission: Coulomb, viscous, breakaway where it shows.

Motor side: from the balance of torques at the motor (`motor_side.py`) in both directions. On
arms without torque sensors that is all friction of the joint. Link side: the sensed torque less
what the model of a free arm needs.
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from limber.arrays import Floats
from limber.identify.arm import Arm, JointBelief
from limber.identify.doubt import MASS_SHARE, Loads
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
)
from limber.identify.regression import Fit, PoorLogError, Unknowns, fit, held_out, ratio
from limber.identify.torque_constant import certain

KAPPA_OFF = 0.03  # beyond it a note is added
SURE = 4.0  # standard errors
SENSOR_SCALE = 0.02  # standard deviation of the scale of a torque sensor
SLOW, LEAST_SLOW = 0.1, 50  # rad/s or m/s, and samples below it that show Coulomb friction
EXTRAPOLATED = 1.0 / 6.0  # of Coulomb's: standard error without slow samples; a third is two
LEAST_REVERSALS = 4
SECTION, LINK_SECTION = "friction", "link_friction"
COULOMB_KEY, VISCOUS_KEY = "coulomb_Nm", "viscous_Nms_per_rad"
KEYS, UNITS = (COULOMB_KEY, VISCOUS_KEY), ("N m", "N m s/rad")
STATIC_KEY, STRIBECK_KEY = "static_Nm", "stribeck_rad_per_s"


def identify(arm: Arm, motion: Motion, weights_share: float | None = None) -> Findings:
    """`weights_share`: how well the URDF's masses are known; None: as CAD usually is."""
    found, own = Findings("friction"), []
    loads = Loads(arm, motion, weights_share or MASS_SHARE)
    for i, joint in enumerate(arm.joints):
        if motion.torque_sensor[i]:
            _link_side(found, joint, loads, i)
        try:
            side = _motor_side(loads, i)
            better = _beats_robot_yaml(joint, side, bool(motion.torque_sensor[i]))
        except PoorLogError as reason:
            side_of = "its motor's side: " if motion.torque_sensor[i] else ""
            found.refused[joint.name] = f"{side_of}{reason}"
            continue
        own += [joint.name] if side.known else []
        _add_motor_side(found, joint, side, bool(motion.torque_sensor[i]), better)
    if own:
        found.notes.append(
            f"{', '.join(own)}: torque constants do not show in this log; friction is given in the "
            "drives' own N m, which is what compensates it."
        )
    return found


def _add_motor_side(
    found: Findings, joint: JointBelief, side: MotorSide, sensor: bool, better: bool
) -> None:
    if abs(side.kappa - 1.0) > KAPPA_OFF:
        found.notes.append(
            f"{joint.name}: its true motor torque is {side.kappa:.3f} of the drive's value; "
            "friction is given in true torque (identify torque-constant)."
        )
    found.notes += [f"{joint.name}: {warning}" for warning in _warnings(side)]
    values = _values(joint, side, sensor)
    unsure = [value.name for value in values if not value.certain]
    if unsure:
        found.notes.append(
            f"{joint.name}: {', '.join(unsure)} less than two standard errors from nothing: not "
            "proposed."
        )
    if not better or (unsure and not _still_better(joint, side, sensor, values)):
        found.notes.append(f"{joint.name}: robot.yaml's friction does as well; it stays.")
        values = [replace(value, path=None, proposed=None) for value in values]
    found.values += values
    found.panels.append(_panel(joint, side))


def _motor_side(loads: Loads, i: int) -> MotorSide:
    """With the torque constant from the same log if it is certain, else that of robot.yaml."""
    try:
        return certain(loads, i)
    except PoorLogError:
        return balance(loads, i, known=True)


def _beats_robot_yaml(joint: JointBelief, side: MotorSide, sensor: bool) -> bool:
    """In parts of the recording that the fit has not seen. Raises PoorLogError if no friction would
    do as well.
    """
    none = side.unseen()
    found = _rms(side.unseen(COULOMB, VISCOUS, STRIBECK))
    if not found < _rms(none):
        raise PoorLogError(
            f"no friction leaves {_rms(none):.3g} N m rms of held-out torques unexplained, the "
            f"best law {found:.3g}: something else is at work; identify gravity first"
        )
    sections = (SECTION,) if sensor else (SECTION, LINK_SECTION)
    believed = sum(_sliding(joint, section, side.speed) for section in sections)
    return found < _rms(none - believed / side.kappa)


def _still_better(joint: JointBelief, side: MotorSide, sensor: bool, values: list[Value]) -> bool:
    """Whether what is certain, beside what robot.yaml has of the rest, does better than that."""
    section = dict(joint.values.get(SECTION) or {})
    section |= {value.path[-1]: value.proposed for value in values if value.certain and value.path}
    mixed = replace(joint, values=joint.values | {SECTION: section})
    none, sections = side.unseen(), (SECTION,) if sensor else (SECTION, LINK_SECTION)
    left = [
        _rms(none - sum(_sliding(each, name, side.speed) for name in sections) / side.kappa)
        for each in (joint, mixed)
    ]
    return left[1] < left[0]


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _sliding(joint: JointBelief, section: str, speed: Floats) -> Floats:
    """Friction of robot.yaml on one side of the transmission, N m."""
    coulomb, viscous, static, stribeck = (
        joint.believed(section, joint.key(key)) or 0.0
        for key in (COULOMB_KEY, VISCOUS_KEY, STATIC_KEY, STRIBECK_KEY)
    )
    total = np.sign(speed) * coulomb + viscous * speed
    if static > coulomb and stribeck > 0.0:
        total += (static - coulomb) * np.sign(speed) * np.exp(-((speed / stribeck) ** 2))
    friction: Floats = total
    return friction


def _warnings(side: MotorSide) -> list[str]:
    """What the motion lacks."""
    found = []
    slow = _slow(side)
    if slow < LEAST_SLOW:
        found.append(
            f"only {slow} of {len(side.speed)} samples are slower than {SLOW:g} rad/s: Coulomb "
            "friction is extrapolated from faster ones and may be a third too high, which its "
            "standard error contains; add a creep"
        )
    reversals = sum(a != b for a, b in pairwise(np.sign(side.speed)))
    if reversals < LEAST_REVERSALS:
        found.append(
            f"it reverses {reversals} times: what depends on the pose may pass for friction; move "
            "there and back through the same places"
        )
    return found


def _slow(side: MotorSide) -> int:
    return int(np.count_nonzero(np.abs(side.speed) < SLOW))


def _widened(side: MotorSide) -> Fit:
    """With the doubt of an extrapolation: Coulomb's friction may be too high by a third."""
    if _slow(side) >= LEAST_SLOW:
        return side.fit
    doubt = np.zeros(len(side.fit.x))
    doubt[COULOMB] = EXTRAPOLATED * side.fit.x[COULOMB]
    return replace(side.fit, covariance=side.fit.covariance + np.outer(doubt, doubt))


def _values(joint: JointBelief, side: MotorSide, sensor: bool) -> list[Value]:
    """Without a torque sensor both sides are measured together: what the link's is believed to be
    is taken off the proposal for the motor's.
    """
    widened = _widened(side)
    found = [
        (COULOMB_KEY, "N m", *ratio(widened, (COULOMB,), LOAD)),
        (VISCOUS_KEY, "N m s/rad", *ratio(widened, (VISCOUS,), LOAD)),
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


def _link_side(found: Findings, joint: JointBelief, loads: Loads, i: int) -> None:
    """From tau = model + F_c sign(v) + d v + o with the model's likely errors; nothing if it does
    not stand out.
    """
    motion = loads.motion
    rows, block = motion.moving[:, i], motion.block[motion.moving[:, i]]
    speed, model = motion.v[rows, i], loads.model[rows, i]
    law = [np.sign(speed), speed, np.ones_like(speed)]
    errors = loads.errors_of_links(rows, i)
    A = np.column_stack([*law, SENSOR_SCALE * model, errors])
    y = loads.torque[rows, i] - model
    unknowns = Unknowns.free(A.shape[1])
    unknowns.low[:2], unknowns.prior[len(law) :] = 0.0, 1.0
    try:
        fitted = fit(A, y, block, unknowns)
    except PoorLogError:
        return
    if not np.any(fitted.x[:2] > SURE * fitted.std[:2]):
        return
    none, left = (
        held_out(A, y, block, unknowns, np.isin(np.arange(A.shape[1]), shown))
        for shown in ([2], [0, 1, 2])
    )
    better = _rms(left) < min(_rms(none), _rms(none - _sliding(joint, LINK_SECTION, speed)))
    if not better:
        found.notes.append(f"{joint.name}: robot.yaml's link_friction does as well; it stays.")
    for key, unit, x, std in zip(KEYS, UNITS, fitted.x, fitted.std, strict=False):
        value = _value(joint, LINK_SECTION, joint.key(key), unit, float(x), float(std), float(x))
        found.values.append(value if better else replace(value, path=None, proposed=None))


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
