"""The weight of the links as the joints feel it, against what the URDF says.

Gravity's torque is linear in mass and mass times centre of each body, g(q) = Y(q) pi, but the
joints see some combinations only (Gautier, Khalil, "Direct calculation of minimum set of inertial
parameters of serial robots", 1990). Estimated is the change of pi that explains the torques and
lies nearest to the URDF, which serves as the prior of a Bayesian least-squares estimate: what
gravity does not show stays as it was. Friction and a constant offset of each joint are estimated
along with it; torque constants and the scale of torque sensors are taken as believed.
"""

from dataclasses import dataclass

import numpy as np

from limber.identify.arm import Arm
from limber.identify.findings import Findings, Panel, Value
from limber.identify.motion import Motion
from limber.identify.motor_side import loads

MASS_SHARE = 0.3  # standard deviation of what the URDF says of a mass,
CENTRE_M = 0.05  # and of a centre of mass
MEASURED = 0.3  # of that deviation: combinations known better than this count as measured
LEAST_NM = 0.1  # by which gravity's torque has to be able to change
LEAST_BLOCKS = 10
GENTLE = 1.0  # rad/s² or m/s²: what is beyond shows inertias, which may be wrong as well
FLOOR_NM = 1e-3  # no torque is known better
ROUNDS = 4


@dataclass(frozen=True)
class Weights:
    """Change of [mass, moment] of every body, kg and kg m; `seen`: how many combinations of them.

    By joint: `own`, Coulomb and viscous friction with a constant offset of its torque, and what is
    unexplained before and after, N m rms.
    """

    change: np.ndarray
    covariance: np.ndarray
    seen: int
    own: np.ndarray  # joints x 3
    offset_std: np.ndarray
    before: np.ndarray
    after: np.ndarray


def identify(arm: Arm, motion: Motion) -> tuple[Findings, Weights | None]:
    found = Findings("weight of the links")
    Y = arm.dynamics.gravity_regressor(motion.q)
    used = []
    for i, joint in enumerate(arm.joints):
        reason = _refusal(arm, motion, Y, i)
        if reason:
            found.refused[joint.name] = reason
        else:
            used.append(i)
    if not used:
        return found, None
    excess = _excess(arm, motion)
    weights = estimate(arm, motion, Y, excess, used)
    found.values = _values(arm, weights) + _offsets(arm, weights, used)
    found.notes.append(
        f"{weights.seen} combinations of masses and centres show in these torques. The change "
        "proposed for the URDF is the least one that explains them; how it is spread over the "
        "links is a choice, their gravity torque is not. Torque constants are taken as believed."
    )
    fits = zip(used, weights.before, weights.after, strict=True)
    found.notes.append(
        "Unexplained, N m rms, before and after: "
        + ", ".join(f"{arm.joints[i].name} {was:.3g} {now:.3g}" for i, was, now in fits)
    )
    g = Y @ arm.dynamics.parameters()
    changed = g + Y @ weights.change
    for k, i in enumerate(used):
        rows = _slow(motion, i)
        measured = (excess + g)[rows, i] - _own(motion, i) @ weights.own[k]
        panel = _panel(arm.joints[i].name, measured, g[rows, i], changed[rows, i])
        found.panels.append(panel)
    return found, weights


def estimate(
    arm: Arm, motion: Motion, Y: np.ndarray, excess: np.ndarray, used: list[int]
) -> Weights:
    """`Y`: gravity_regressor(); `excess`: torque at the joints beyond the model's, N x n."""
    size = 4 * arm.dynamics.size
    prior = _prior_std(arm)
    unknowns = size + 3 * len(used)
    problems = []
    for k, i in enumerate(used):
        rows = _slow(motion, i)
        A = np.zeros((np.count_nonzero(rows), unknowns))
        A[:, :size] = Y[rows, i]
        own = slice(size + 3 * k, size + 3 * k + 3)
        A[:, own] = _own(motion, i)
        samples_of_block = len(A) / len(np.unique(motion.block[rows]))
        problems.append((A, excess[rows, i], samples_of_block))
    sigma = [max(float(np.std(r)), FLOOR_NM) for _, r, _ in problems]
    before = [_unexplained(A[:, size:], r) for A, r, _ in problems]
    for _ in range(ROUNDS):  # the weight of each joint follows from what stays unexplained in it
        H, h = np.zeros((unknowns, unknowns)), np.zeros(unknowns)
        H[range(size), range(size)] = prior**-2.0
        for (A, r, together), std in zip(problems, sigma, strict=True):
            H += A.T @ A / (std**2 * together)
            h += A.T @ r / (std**2 * together)
        covariance = np.linalg.inv(H)
        x = covariance @ h
        sigma = [max(float(np.std(r - A @ x)), FLOOR_NM) for A, r, _ in problems]
    changes, offsets = slice(size), slice(size + 2, None, 3)
    whitened = covariance[changes, changes] / np.outer(prior, prior)
    return Weights(
        x[changes],
        covariance[changes, changes],
        int(np.count_nonzero(np.linalg.eigvalsh(whitened) < MEASURED**2)),
        x[size:].reshape(-1, 3),
        np.sqrt(np.diag(covariance))[offsets],
        np.array(before),
        np.array(sigma),
    )


def _refusal(arm: Arm, motion: Motion, Y: np.ndarray, i: int) -> str:
    rows = _slow(motion, i)
    if arm.joints[i].two_motors:
        return "two motors pull at this joint"
    if len(np.unique(motion.block[rows])) < LEAST_BLOCKS:
        return "it moves too little"
    swing = float(np.linalg.norm(np.ptp(Y[rows, i], axis=0) * _prior_std(arm)))
    if not swing > LEAST_NM:
        return f"what the URDF may be wrong by changes its torque by only {swing:.2g} N m"
    return ""


def _slow(motion: Motion, i: int) -> np.ndarray:
    """Samples in which joint i moves and no joint speeds up much."""
    return motion.moving[:, i] & (np.abs(motion.a).max(axis=1) < GENTLE)


def _own(motion: Motion, i: int) -> np.ndarray:
    """Coulomb and viscous friction and offset of joint i, per unit, in its slow samples."""
    speed = motion.v[_slow(motion, i), i]
    return np.stack([np.sign(speed), speed, np.ones_like(speed)], axis=1)


def _excess(arm: Arm, motion: Motion) -> np.ndarray:
    """Sensed torque or, without a sensor, motor torque, less what model and rotor need."""
    inertia = np.array([joint.rotor_inertia for joint in arm.joints])
    driven = motion.motor - inertia * motion.theta_ddot
    measured = np.where(motion.torque_sensor, loads(arm, motion), driven)
    return measured - arm.dynamics.torque(motion.q, motion.v, motion.a)


def _prior_std(arm: Arm) -> np.ndarray:
    return np.concatenate(
        [[body.mass * MASS_SHARE] + 3 * [body.mass * CENTRE_M] for body in arm.dynamics.bodies]
    )


def _unexplained(A: np.ndarray, r: np.ndarray) -> float:
    """By friction and offset alone, rms."""
    return float(np.std(r - A @ np.linalg.lstsq(A, r, rcond=None)[0]))


def changed_link(arm: Arm, weights: Weights, i: int) -> tuple[str, float, np.ndarray]:
    """The heaviest link of body i with the mass and centre (its own frame) it should have."""
    body = arm.dynamics.bodies[i]
    d_mass, d_moment = weights.change[4 * i], weights.change[4 * i + 1 : 4 * i + 4]
    R, p = body.X_CH[:3, :3], body.X_CH[:3, 3]
    mass = body.inertial.mass + d_mass
    moment = body.inertial.mass * (R @ body.inertial.com + p) + d_moment
    return body.heaviest, float(mass), R.T @ (moment / mass - p)


def _values(arm: Arm, weights: Weights) -> list[Value]:
    values = []
    std = np.sqrt(np.diag(weights.covariance))
    for i, body in enumerate(arm.dynamics.bodies):
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
        {"as the URDF says": before},
    )
