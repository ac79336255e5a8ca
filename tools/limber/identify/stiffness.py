"""Stiffness of joint springs: how far the motor is ahead of the link for the torque between them.

    theta - q = tau / K_J + T (q' + T q''/2) + offset

T is by how much the link's encoder answers later than the motor's, tau what the joint's torque
sensor reads or, without one, what the model of a free arm needs. The deflection is fitted to the
torque and not the other way round, because a sensor whose counts are coarse against the deflection
then biases nothing. For two motors with quadratic springs, preload c and equilibrium e, likewise
2 c (e - q) = tau / k2 + T q' + offset, both tendons taut.
"""

import numpy as np

from limber.arrays import Floats
from limber.identify.arm import Arm, JointBelief
from limber.identify.findings import AGAINST_URDF, Findings, Panel, Value
from limber.identify.motion import Motion
from limber.identify.regression import Fit, PoorLogError, fit

WORST_STD = 0.1  # of the stiffness
DELAY = 2  # which unknown
SURE = 4.0  # standard errors
LEAST_DELAY_S = 1e-5
LAWS = {"elastic": "linear", "antagonistic": "quadratic"}
KEYS = {"elastic": "stiffness_Nm_per_rad", "antagonistic": "k2_Nm_per_rad2"}


def identify(arm: Arm, motion: Motion) -> Findings:
    found = Findings("joint stiffness")
    model = arm.robot.dynamics.torque(motion.q, motion.v, motion.a)
    for i, joint in enumerate(arm.joints):
        sensed = bool(motion.torque_sensor[i])
        tau = motion.tau[:, i] if sensed else model[:, i]
        try:
            key = _key(joint, bool(motion.link_encoder[i]))
            bend = _bend(joint, motion, i)
            fitted = _fit(motion, tau, bend, i, sensed)
        except PoorLogError as reason:
            found.refused[joint.name] = str(reason)
            continue
        value = _value(joint, key, fitted)
        found.values += [value, *_delay(joint, fitted)]
        found.panels.append(_panel(joint, tau, bend, fitted, value.believed))
    if found.values and not motion.torque_sensor.all():
        found.notes.append(AGAINST_URDF)
    return found


def _key(joint: JointBelief, link_encoder: bool) -> str:
    """Of the spring's number in robot.yaml."""
    kind = joint.transmission["kind"]
    if kind == "rigid":
        raise PoorLogError("its transmission is rigid: there is no spring to measure")
    law = joint.transmission["spring"]["law"]
    if law != LAWS[kind]:
        raise PoorLogError(f"its spring law is {law}; only {LAWS[kind]} ones are fitted here")
    if not link_encoder:
        raise PoorLogError("it has no link encoder: theta - q is not measured")
    return joint.key(KEYS[kind])


def _bend(joint: JointBelief, motion: Motion, i: int) -> Floats:
    """What the torque is proportional to."""
    deflection = motion.theta[:, i] - motion.q[:, i]
    bend: Floats = 2.0 * motion.preload[:, i] * deflection if joint.two_motors else deflection
    return bend


def _fit(motion: Motion, tau: Floats, bend: Floats, i: int, sensed: bool) -> Fit:
    columns, block = [tau, np.ones_like(tau)], motion.block
    if motion.moving[:, i].any():
        columns.append(_travel(motion, columns, bend, i))
    if not sensed:  # friction of the link takes part of the torque, by direction
        rows = motion.moving[:, i]
        columns = [column[rows] for column in [*columns, np.sign(motion.v[:, i])]]
        bend, block = bend[rows], block[rows]
        if not rows.any():
            raise PoorLogError("it does not move")
    fitted = fit(np.stack(columns, axis=1), bend, block)
    if not fitted.std[0] < WORST_STD * fitted.x[0]:
        raise PoorLogError(
            f"its torque changes by only {np.ptp(tau):.2g} N m, which bends the spring too little "
            "for its encoders"
        )
    return fitted


def _travel(motion: Motion, columns: list[Floats], bend: Floats, i: int) -> Floats:
    """How far the link goes during a delay, per second of it, to second order."""
    v = motion.v[:, i]
    first = fit(np.column_stack([*columns, v]), bend, motion.block)
    travel: Floats = v + first.x[DELAY] / 2.0 * motion.a[:, i]
    return travel


def _value(joint: JointBelief, key: str, fitted: Fit) -> Value:
    stiffness = float(1.0 / fitted.x[0])
    path = ("joints", joint.name, "transmission", "spring", key)
    believed = joint.believed("transmission", "spring", key)
    std = float(fitted.std[0] * stiffness**2)
    unit = "N/m" if joint.prismatic else "N m/rad"
    unit += "²" if joint.two_motors else ""
    return Value(joint.name, key, unit, stiffness, std, believed, path, stiffness)


def _delay(joint: JointBelief, fitted: Fit) -> list[Value]:
    """Of the link's encoder against the motor's, if it stands out; of two motors it is not told."""
    if joint.two_motors or len(fitted.x) <= DELAY:
        return []
    delay, std = float(fitted.x[DELAY]), float(fitted.std[DELAY])
    if not abs(delay) > max(SURE * std, LEAST_DELAY_S):
        return []
    return [Value(joint.name, "link encoder later than motor's", "s", delay, std)]


def _panel(
    joint: JointBelief, tau: Floats, bend: Floats, fitted: Fit, believed: float | None
) -> Panel:
    ends = np.array([tau.min(), tau.max()])
    offset = fitted.x[1]
    lines = {f"measured: {1.0 / fitted.x[0]:.4g}": (ends, 1e3 * (ends * fitted.x[0] + offset))}
    if believed:
        lines[f"as believed: {believed:.4g}"] = (ends, 1e3 * (ends / believed + offset))
    unit = "m" if joint.prismatic else "rad"
    y_label = f"motor ahead of link (m{unit})"
    if joint.two_motors:
        y_label = f"2 c (e - q) (1e-3 {unit}²)"
    return Panel(joint.name, "joint torque (N m)", y_label, tau, 1e3 * bend, lines)
