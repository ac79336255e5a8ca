"""The weight of the links from joint torques, compared with the URDF.

`weights.py` has the estimate. Torque constants and the scale of torque sensors are taken as
believed: the weights are in the drives' own N m, which is what holds the arm up.
"""

import numpy as np

from limber.arrays import Floats
from limber.identify.arm import Arm
from limber.identify.doubt import Loads, prior_std
from limber.identify.findings import Findings, Panel, Value
from limber.identify.motion import Motion
from limber.identify.regression import PoorLogError
from limber.identify.weights import (
    Problem,
    Weights,
    doubts,
    estimate,
    held_out,
    own_terms,
    problems,
)
from limber.model.dynamics import PARAMETERS, UPPER

LEAST_NM = 0.1  # by which gravity's torque has to be able to change
LEAST_BLOCKS = 10
OFFSET_SHARES = (0.1, 0.01)  # of the greatest torque of a joint: likely offsets
WORSE = 1.01  # of what was unexplained before
ENOUGH = 0.8  # of held-out squares: what else is proposed has to leave less


def identify(arm: Arm, motion: Motion) -> Findings:
    found = Findings("weight of the links")
    loads = Loads(arm, motion)
    found.refused = _refusals(loads)
    used = [i for i, joint in enumerate(arm.joints) if joint.name not in found.refused]
    if not used:
        return found
    excess = _excess(loads)
    try:
        weights, before, after, kept = _best(loads, excess, used)
    except PoorLogError as error:
        found.refused |= {arm.joints[i].name: str(error) for i in used}
        return found
    found.values = _values(arm, weights) + _offsets(arm, weights, used)
    found.notes = _notes(arm, weights, used, before, after) + kept
    reason = _no_better(arm, used, before, after)
    if reason:
        found.notes.append(reason)
    else:
        links = [changed_link(arm, weights.change, i) for i in range(arm.robot.dynamics.size)]
        found.inertials = {link: (mass, com) for link, mass, com in links}
    change = loads.regressor @ weights.change
    for k, i in enumerate(used):
        rows = motion.moving[:, i]
        measured = (excess + loads.model)[rows, i] - own_terms(loads, i) @ weights.own[k]
        model = loads.model[rows, i]
        found.panels.append(_panel(arm.joints[i].name, measured, model, model + change[rows, i]))
    return found


def _best(
    loads: Loads, excess: Floats, used: list[int]
) -> tuple[Weights, Floats, Floats, list[str]]:
    """An estimate, and what URDF and proposal leave of held-out torques; if offsets of the torques
    would take what weights have to explain, without offsets. Links whose change makes a joint worse
    stay as the URDF has them, if that helps: notes name them.
    """
    arm = loads.arm
    for share in OFFSET_SHARES:
        parts = problems(loads, excess, used, share)
        found = _judged(loads, parts, used, [])
        if not _no_better(arm, used, *found[1:]):
            return *found, []
    kept, fewer = _fewer(loads, parts, used, found)
    if _no_better(arm, used, *fewer[1:]):
        return *found, []
    bodies = arm.robot.dynamics.bodies
    links = ", ".join(bodies[i].heaviest for i in kept)
    worse = ", ".join(_worse(arm, used, *found[1:]))
    return *fewer, [
        f"Left as in the URDF: {links}. With them changed, too, held-out torques of "
        f"{worse} would be explained worse."
    ]


Judged = tuple[Weights, Floats, Floats]


def _judged(loads: Loads, parts: list[Problem], used: list[int], kept: list[int]) -> Judged:
    prior = doubts(loads, kept)
    weights = estimate(loads, parts, used, prior)
    before, after = held_out(loads, parts, used, prior, lambda change: _of_urdf(loads.arm, change))
    return weights, before, after


def _fewer(
    loads: Loads, parts: list[Problem], used: list[int], found: Judged
) -> tuple[list[int], Judged]:
    """Bodies left as they are, one after the other, whichever leaves least of the joints that the
    others make worse, until none is.
    """
    arm = loads.arm
    kept: list[int] = []

    def harm(judged: Judged) -> tuple[int, float]:
        share = judged[2] / judged[1]
        return len(_worse(arm, used, *judged[1:])), float(np.sum(share**2))

    open_bodies = [i for i, body in enumerate(arm.robot.dynamics.bodies) if body.mass > 0]
    while harm(found)[0] and len(open_bodies) > 1:
        tries = {i: _judged(loads, parts, used, [*kept, i]) for i in open_bodies}
        best = min(tries, key=lambda i: harm(tries[i]))
        kept, found = [*kept, best], tries[best]
        open_bodies.remove(best)
    return sorted(kept), found


def _worse(arm: Arm, used: list[int], before: Floats, after: Floats) -> list[str]:
    """Joints, with what was and would be unexplained."""
    return [
        f"{arm.joints[i].name} ({after[k]:.3g} N m rms instead of {before[k]:.3g})"
        for k, i in enumerate(used)
        if after[k] > WORSE * before[k]
    ]


def _no_better(arm: Arm, used: list[int], before: Floats, after: Floats) -> str:
    """Why other weights than the URDF's are not proposed; empty if they are."""
    if not np.sum((after / before) ** 2) < ENOUGH * len(used):
        return "The URDF explains held-out torques as well: no other is proposed."
    worse = _worse(arm, used, before, after)
    if worse:
        return (
            f"No other URDF is proposed: held-out torques of {', '.join(worse)} would be explained "
            "worse. Something other than weights is in them, or the tour is too small."
        )
    return ""


def _notes(arm: Arm, weights: Weights, used: list[int], before: Floats, after: Floats) -> list[str]:
    fits = zip(used, before, after, strict=True)
    return [
        f"{weights.seen} combinations of masses, centres and inertias show in these torques. The "
        "change proposed for the URDF is the least one that explains them; how it is spread over "
        "the links is a choice, their gravity torque is not. Torque constants are taken as "
        "believed.",
        "Unexplained of held-out torques, N m rms, before and after: "
        + ", ".join(f"{arm.joints[i].name} {was:.3g} {now:.3g}" for i, was, now in fits),
    ]


def _refusals(loads: Loads) -> dict[str, str]:
    """By joint. One that feels no weight still counts, by inertia, if another feels some."""
    joints = loads.arm.joints
    found = {joint.name: _refusal(loads, i) for i, joint in enumerate(joints)}
    found = {name: reason for name, reason in found.items() if reason}
    light = {j.name: _swing(loads, i) for i, j in enumerate(joints) if j.name not in found}
    if light and max(light.values()) < LEAST_NM:
        for name, swing in light.items():
            found[name] = f"likely errors of the URDF change its torque by only {swing:.2g} N m"
    return found


def _refusal(loads: Loads, i: int) -> str:
    arm, motion = loads.arm, loads.motion
    empty = [body.heaviest for body in arm.robot.dynamics.bodies if not body.mass > 0]
    if empty:
        return f"the URDF gives no mass to {', '.join(empty)}; give each a mass, however small"
    if arm.joints[i].two_motors:
        return "two motors pull at this joint"
    if not (motion.torque_sensor[i] or motion.motor_known[i]):
        return "the recording does not hold its torque"
    rows = motion.moving[:, i]
    blocks = len(np.unique(motion.block[rows]))
    if blocks < LEAST_BLOCKS:
        return (
            f"it moves too little: in {np.count_nonzero(rows)} of {len(rows)} samples it moves one "
            f"way for a while, {blocks} half seconds of {LEAST_BLOCKS} that are needed"
        )
    return ""


def _swing(loads: Loads, i: int) -> float:
    """By how much likely errors of weights change the torque of joint i over the motion, N m."""
    rows = loads.motion.moving[:, i]
    Y = loads.arm.robot.dynamics.gravity_regressor(loads.motion.q[rows])[:, i]
    likely = prior_std(loads.arm).reshape(-1, PARAMETERS)[:, :4].ravel()
    return float(np.linalg.norm(np.ptp(Y, axis=0) * likely))


def _excess(loads: Loads) -> Floats:
    """Sensed torque or, without a sensor, motor torque, less what model and rotor need."""
    motion = loads.motion
    inertia = np.array([joint.rotor_inertia for joint in loads.arm.joints])
    driven = motion.motor - inertia * motion.theta_ddot
    excess: Floats = np.where(motion.torque_sensor, loads.torque, driven) - loads.model
    return excess


def _of_urdf(arm: Arm, change: Floats) -> Floats:
    """The change of all parameters that other masses and centres of the heaviest links make, their
    inertias about their centres left as they are.
    """
    found = np.zeros_like(change)
    for i, body in enumerate(arm.robot.dynamics.bodies):
        _, mass, com = changed_link(arm, change, i)
        R, p = body.X_CH[:3, :3], body.X_CH[:3, 3]
        old, new = R @ body.inertial.com + p, R @ com + p
        part = found[PARAMETERS * i : PARAMETERS * (i + 1)]
        part[0] = mass - body.inertial.mass
        part[1:4] = mass * new - body.inertial.mass * old
        part[4:] = (_about(mass, new) - _about(body.inertial.mass, old))[UPPER]
    return found


def _about(mass: float, p: Floats) -> Floats:
    """Inertia of a point mass."""
    inertia: Floats = mass * (p @ p * np.eye(3) - np.outer(p, p))
    return inertia


def changed_link(arm: Arm, change: Floats, i: int) -> tuple[str, float, Floats]:
    """The heaviest link of body i with the mass and centre (its own frame) it should have."""
    body = arm.robot.dynamics.bodies[i]
    d_mass, d_moment = change[PARAMETERS * i], change[PARAMETERS * i + 1 : PARAMETERS * i + 4]
    R, p = body.X_CH[:3, :3], body.X_CH[:3, 3]
    mass = body.inertial.mass + d_mass
    moment = body.inertial.mass * (R @ body.inertial.com + p) + d_moment
    return body.heaviest, float(mass), R.T @ (moment / mass - p)


def _values(arm: Arm, weights: Weights) -> list[Value]:
    values = []
    for i, body in enumerate(arm.robot.dynamics.bodies):
        link, mass, com = changed_link(arm, weights.change, i)
        R, p = body.X_CH[:3, :3], body.X_CH[:3, 3]
        four = slice(PARAMETERS * i, PARAMETERS * i + 4)
        cov = weights.covariance[four, four]
        slope = np.column_stack([-(com + R.T @ p), R.T]) / mass  # of the centre, by the four
        name, believed = arm.joints[i].name, body.inertial.mass
        std = float(np.sqrt(cov[0, 0]))
        values.append(Value(name, f"mass of {link}", "kg", mass, std, believed))
        spread = np.sqrt(np.diag(slope @ cov @ slope.T))
        for axis, value, before, std in zip("xyz", com, body.inertial.com, spread, strict=True):
            title = f"centre of {link}, {axis}"
            values.append(Value(name, title, "m", float(value), float(std), before))
    return values


def _offsets(arm: Arm, weights: Weights, used: list[int]) -> list[Value]:
    """Of torque sensors their bias, of motors what their torque is off by."""
    offsets = zip(used, weights.own[:, 2], weights.offset_std, strict=True)
    return [
        Value(arm.joints[i].name, "torque at no load", "N m", float(x), float(std), 0.0)
        for i, x, std in offsets
    ]


def _panel(name: str, measured: Floats, before: Floats, after: Floats) -> Panel:
    ends = np.array([after.min(), after.max()])
    return Panel(
        name,
        "torque of the model with the change (N m)",
        "torque less friction\nand offset (N m)",
        after,
        measured,
        {"with the change": (ends, ends)},
        {"URDF": before},
    )
