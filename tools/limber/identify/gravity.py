"""The weight of the links from joint torques, compared with the URDF.

From slow motions; `weights.py` has the estimate. Torque constants and the scale of torque sensors
are taken as believed.
"""

import numpy as np

from limber.identify.arm import Arm
from limber.identify.findings import Findings, Panel, Value
from limber.identify.motion import Motion
from limber.identify.motor_side import loads
from limber.identify.weights import Weights, estimate, own_terms, prior_std, slow

LEAST_NM = 0.1  # by which gravity's torque has to be able to change
LEAST_BLOCKS = 10


def identify(arm: Arm, motion: Motion) -> Findings:
    found = Findings("weight of the links")
    Y = arm.robot.dynamics.gravity_regressor(motion.q)
    used = []
    for i, joint in enumerate(arm.joints):
        reason = _refusal(arm, motion, Y, i)
        if reason:
            found.refused[joint.name] = reason
        else:
            used.append(i)
    if not used:
        return found
    excess = _excess(arm, motion)
    weights = estimate(arm, motion, Y, excess, used)
    found.values = _values(arm, weights) + _offsets(arm, weights, used)
    found.notes = _notes(arm, weights, used)
    links = [changed_link(arm, weights, i) for i in range(arm.robot.dynamics.size)]
    found.inertials = {link: (mass, com) for link, mass, com in links}
    g = Y @ arm.robot.dynamics.parameters()
    changed = g + Y @ weights.change
    for k, i in enumerate(used):
        rows = slow(motion, i)
        measured = (excess + g)[rows, i] - own_terms(motion, i) @ weights.own[k]
        panel = _panel(arm.joints[i].name, measured, g[rows, i], changed[rows, i])
        found.panels.append(panel)
    return found


def _notes(arm: Arm, weights: Weights, used: list[int]) -> list[str]:
    fits = zip(used, weights.before, weights.after, strict=True)
    return [
        f"{weights.seen} combinations of masses and centres show in these torques. The change "
        "proposed for the URDF is the least one that explains them; how it is spread over the "
        "links is a choice, their gravity torque is not. Torque constants are taken as believed.",
        "Unexplained, N m rms, before and after: "
        + ", ".join(f"{arm.joints[i].name} {was:.3g} {now:.3g}" for i, was, now in fits),
    ]


def _refusal(arm: Arm, motion: Motion, Y: np.ndarray, i: int) -> str:
    empty = [body.heaviest for body in arm.robot.dynamics.bodies if not body.mass > 0]
    if empty:
        return f"the URDF gives no mass to {', '.join(empty)}; give each a mass, however small"
    rows = slow(motion, i)
    if arm.joints[i].two_motors:
        return "two motors pull at this joint"
    if len(np.unique(motion.block[rows])) < LEAST_BLOCKS:
        return "it moves too little"
    swing = float(np.linalg.norm(np.ptp(Y[rows, i], axis=0) * prior_std(arm)))
    if not swing > LEAST_NM:
        return f"likely errors of the URDF change its torque by only {swing:.2g} N m"
    return ""


def _excess(arm: Arm, motion: Motion) -> np.ndarray:
    """Sensed torque or, without a sensor, motor torque, less what model and rotor need."""
    inertia = np.array([joint.rotor_inertia for joint in arm.joints])
    driven = motion.motor - inertia * motion.theta_ddot
    measured = np.where(motion.torque_sensor, loads(arm, motion), driven)
    return measured - arm.robot.dynamics.torque(motion.q, motion.v, motion.a)


def changed_link(arm: Arm, weights: Weights, i: int) -> tuple[str, float, np.ndarray]:
    """The heaviest link of body i with the mass and centre (its own frame) it should have."""
    body = arm.robot.dynamics.bodies[i]
    d_mass, d_moment = weights.change[4 * i], weights.change[4 * i + 1 : 4 * i + 4]
    R, p = body.X_CH[:3, :3], body.X_CH[:3, 3]
    mass = body.inertial.mass + d_mass
    moment = body.inertial.mass * (R @ body.inertial.com + p) + d_moment
    return body.heaviest, float(mass), R.T @ (moment / mass - p)


def _values(arm: Arm, weights: Weights) -> list[Value]:
    values = []
    std = np.sqrt(np.diag(weights.covariance))
    for i, body in enumerate(arm.robot.dynamics.bodies):
        link, mass, com = changed_link(arm, weights, i)
        name = arm.joints[i].name
        believed = body.inertial.mass
        values.append(Value(name, f"mass of {link}", "kg", mass, float(std[4 * i]), believed))
        for axis, value, before, deviation in zip(
            "xyz", com, body.inertial.com, std[4 * i + 1 : 4 * i + 4] / mass, strict=True
        ):
            values.append(
                Value(name, f"centre of {link}, {axis}", "m", float(value), deviation, before)
            )
    return values


def _offsets(arm: Arm, weights: Weights, used: list[int]) -> list[Value]:
    """Of torque sensors their bias, of motors what their torque is off by."""
    offsets = zip(used, weights.own[:, 2], weights.offset_std, strict=True)
    return [
        Value(arm.joints[i].name, "torque at no load", "N m", float(x), float(std), 0.0)
        for i, x, std in offsets
    ]


def _panel(name: str, measured: np.ndarray, before: np.ndarray, after: np.ndarray) -> Panel:
    ends = np.array([after.min(), after.max()])
    return Panel(
        name,
        "gravity torque with the change (N m)",
        "torque less friction\nand offset (N m)",
        after,
        measured,
        {"with the change": (ends, ends)},
        {"URDF": before},
    )
