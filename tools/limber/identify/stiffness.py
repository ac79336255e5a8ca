"""Stiffness of joint springs: how far the motor is ahead of the link for the torque between them.

    theta - q = tau / K_J + offset

tau is what the joint's torque sensor reads or, without one, what the model of a free arm needs. The
deflection is fitted to the torque and not the other way round, because a sensor whose counts are
coarse against the deflection then biases nothing.
"""

import numpy as np

from limber.identify.arm import Arm, JointBelief
from limber.identify.findings import Findings, Panel, Value
from limber.identify.motion import Motion
from limber.identify.regression import Fit, PoorLogError, fit

WORST_STD = 0.1  # of the stiffness


def identify(arm: Arm, motion: Motion) -> Findings:
    found = Findings("joint stiffness")
    model = arm.dynamics.torque(motion.q, motion.v, motion.a)
    for i, joint in enumerate(arm.joints):
        try:
            _refuse(joint, bool(motion.link_encoder[i]))
            sensed = bool(motion.torque_sensor[i])
            tau = motion.tau[:, i] if sensed else model[:, i]
            fitted = _fit(motion, tau, i, sensed)
        except PoorLogError as reason:
            found.refused[joint.name] = str(reason)
            continue
        key = joint.key("stiffness_Nm_per_rad")
        stiffness = float(1.0 / fitted.x[0])
        path = ("joints", joint.name, "transmission", "spring", key)
        believed = joint.believed("transmission", "spring", key)
        std = float(fitted.std[0] * stiffness**2)
        unit = "N/m" if joint.prismatic else "N m/rad"
        found.values.append(Value(joint.name, key, unit, stiffness, std, believed, path, stiffness))
        deflection = motion.theta[:, i] - motion.q[:, i]
        found.panels.append(_panel(joint, tau, deflection, fitted, believed))
        if not sensed:
            found.notes.append(
                f"{joint.name} has no torque sensor: its torque is the model's, so weights in the "
                "URDF and link friction are in the result."
            )
    return found


def _refuse(joint: JointBelief, link_encoder: bool) -> None:
    kind = joint.transmission.get("kind")
    if kind == "antagonistic":
        raise PoorLogError("two motors pull at this joint, each through a spring of its own")
    if kind != "elastic":
        raise PoorLogError(f"its transmission is {kind}: there is no spring to measure")
    law = joint.transmission["spring"]["law"]
    if law != "linear":
        raise PoorLogError(f"its spring law is {law}; only linear springs are fitted")
    if not link_encoder:
        raise PoorLogError("it has no link encoder: theta - q is not measured")


def _fit(motion: Motion, tau: np.ndarray, i: int, sensed: bool) -> Fit:
    deflection, block = motion.theta[:, i] - motion.q[:, i], motion.block
    columns = [tau, np.ones_like(tau)]
    if not sensed:  # friction of the link takes part of the torque, by direction
        rows = motion.moving[:, i]
        columns = [column[rows] for column in [*columns, np.sign(motion.v[:, i])]]
        deflection, block = deflection[rows], block[rows]
        if not rows.any():
            raise PoorLogError("it does not move")
    fitted = fit(np.stack(columns, axis=1), deflection, block)
    if not fitted.std[0] < WORST_STD * fitted.x[0]:
        raise PoorLogError(
            f"its torque changes by only {np.ptp(tau):.2g} N m, which bends the spring too little "
            "for its encoders"
        )
    return fitted


def _panel(
    joint: JointBelief, tau: np.ndarray, deflection: np.ndarray, fitted: Fit, believed: float | None
) -> Panel:
    ends = np.array([tau.min(), tau.max()])
    offset = fitted.x[1]
    lines = {f"measured: {1.0 / fitted.x[0]:.4g}": (ends, 1e3 * (ends * fitted.x[0] + offset))}
    if believed:
        lines[f"as believed: {believed:.4g}"] = (ends, 1e3 * (ends / believed + offset))
    unit = "mm" if joint.prismatic else "mrad"
    y_label = f"motor ahead of link ({unit})"
    return Panel(joint.name, "joint torque (N m)", y_label, tau, 1e3 * deflection, lines)
