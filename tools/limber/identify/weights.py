"""Masses and centres of mass that explain the torques of a motion.

Torque is linear in mass, mass times centre and inertia of each body, tau = Y(q, v, a) pi, but the
joints see some combinations only (Gautier, Khalil, "Direct calculation of minimum set of inertial
parameters of serial robots", 1990). Estimated is the change of pi that explains the torques and
lies nearest to the URDF, which serves as the prior of a Bayesian least-squares estimate: what
the torques do not show stays as it was. Friction, offset and scale of the torque of each joint, and
errors of inertias, are estimated along with it.
"""

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass

import numpy as np

from limber.identify.doubt import ROTOR_SHARE, Loads, prior_std
from limber.identify.regression import FLOOR, FOLDS, Fit, Unknowns, fit, solve
from limber.model.dynamics import PARAMETERS

SCALE = 0.02  # standard deviation of torque constants and of the scale of torque sensors
MEASURED = 0.3  # of its prior deviation: combinations known better than this count as measured
LIGHTEST, HEAVIEST = -0.8, 3.0  # change of a mass, in shares of it
ROUNDS = 3
OWN = 5  # columns of each joint: Coulomb, viscous, offset, rotor, scale of its torque


@dataclass(frozen=True)
class Weights:
    """Change of the 10 parameters of every body; `seen`: how many combinations of them.

    By joint: `own`, in the order of OWN; what is unexplained before and after, N m rms.
    """

    change: np.ndarray
    covariance: np.ndarray
    seen: int
    own: np.ndarray  # joints x OWN
    offset_std: np.ndarray
    before: np.ndarray
    after: np.ndarray


@dataclass(frozen=True)
class Problem:
    """A x = r of one joint, and which half second each row is of. `offset`: a likely one."""

    A: np.ndarray
    r: np.ndarray
    block: np.ndarray
    offset: float


def problems(
    loads: Loads, excess: np.ndarray, used: list[int], offset_share: float
) -> list[Problem]:
    """`excess`: torque at the joints beyond the model's, N x n."""
    found = []
    size = loads.regressor.shape[2]
    for k, i in enumerate(used):
        rows = loads.motion.moving[:, i]
        A = np.zeros((np.count_nonzero(rows), size + OWN * len(used)))
        A[:, :size] = loads.regressor[rows, i]
        A[:, size + OWN * k : size + OWN * (k + 1)] = own_terms(loads, i)
        r = excess[rows, i]
        likely = offset_share * float(np.abs(r + loads.model[rows, i]).max()) + FLOOR
        found.append(Problem(A, r, loads.motion.block[rows], likely))
    return found


def doubts(loads: Loads, kept: Collection[int]) -> np.ndarray:
    """Standard deviations of the parameters; bodies in `kept` stay as the URDF has them."""
    prior = prior_std(loads.arm, loads.weights_share)
    for i in kept:
        prior[PARAMETERS * i : PARAMETERS * (i + 1)] = 0.0
    return prior


def estimate(loads: Loads, parts: list[Problem], used: list[int], prior: np.ndarray) -> Weights:
    """`prior`: of doubts()."""
    unknowns = _unknowns(loads, parts, used, prior)
    size = len(prior)
    before = [_unexplained(part, size) for part in parts]
    sigma, found = _fit(parts, unknowns)
    covariance = found.covariance
    changes = covariance[:size, :size]
    live = prior > 0
    relative = changes[np.ix_(live, live)] / np.outer(prior[live], prior[live])
    return Weights(
        found.x[:size],
        changes,
        int(np.count_nonzero(np.linalg.eigvalsh(relative) < MEASURED**2)),
        found.x[size:].reshape(-1, OWN),
        np.sqrt(np.diag(covariance))[size + 2 :: OWN],
        np.array(before),
        sigma,
    )


def held_out(
    loads: Loads,
    parts: list[Problem],
    used: list[int],
    prior: np.ndarray,
    changed: Callable[[np.ndarray], np.ndarray],
) -> np.ndarray:
    """Per joint, rms of what URDF and friction leave of torques at places that the fit has not
    seen, before and after; 2 x joints. `changed`: from a change of all parameters to the one that a
    URDF with other masses and centres makes. Offsets count as unexplained.
    """
    unknowns, size = _unknowns(loads, parts, used, prior), len(prior)
    left = [[np.zeros(len(part.r)) for part in parts] for _ in range(2)]
    for out in places(loads):
        x = _balanced([_without(part, out) for part in parts], unknowns)[1]
        proposed = changed(x[:size])
        for k, part in enumerate(parts):
            rows = np.isin(part.block, out)
            own = slice(size + OWN * k, size + OWN * k + 2)
            friction = part.A[rows, own] @ x[own]
            left[0][k][rows] = part.r[rows] - friction
            left[1][k][rows] = part.r[rows] - friction - part.A[rows, :size] @ proposed
    return np.array([[np.sqrt(np.mean(r**2)) for r in each] for each in left])


def places(loads: Loads) -> Iterator[np.ndarray]:
    """Half seconds in FOLDS parts of the space of poses, along its longest direction: the same
    poses passed once more would not show what a fit makes of others.
    """
    motion = loads.motion
    blocks = np.unique(motion.block)
    poses = np.array([motion.q[motion.block == block].mean(axis=0) for block in blocks])
    poses -= poses.mean(axis=0)
    longest = np.linalg.svd(poses, full_matrices=False)[2][0]
    yield from np.array_split(blocks[np.argsort(poses @ longest)], FOLDS)


def own_terms(loads: Loads, i: int) -> np.ndarray:
    """Of joint i per unit while it moves, in the order of OWN."""
    motion = loads.motion
    rows = motion.moving[:, i]
    speed = motion.v[rows, i]
    rotor = motion.theta_ddot[rows, i] * (not motion.torque_sensor[i])
    model = loads.model[rows, i]
    return np.stack([np.sign(speed), speed, np.ones_like(speed), rotor, model], axis=1)


def _unknowns(loads: Loads, parts: list[Problem], used: list[int], prior: np.ndarray) -> Unknowns:
    found = Unknowns.free(parts[0].A.shape[1])
    size = len(prior)
    found.prior[:size] = np.maximum(prior, 1e-12)
    for k, i in enumerate(used):
        own = size + OWN * k
        found.low[own : own + 2] = 0.0
        found.prior[own + 2] = parts[k].offset
        found.prior[own + 3] = ROTOR_SHARE * loads.arm.joints[i].rotor_inertia + 1e-12
        found.prior[own + 4] = SCALE
    for j, body in enumerate(loads.arm.robot.dynamics.bodies):
        mass = body.inertial.mass
        found.low[10 * j], found.high[10 * j] = LIGHTEST * mass, HEAVIEST * mass
    return found


def _without(part: Problem, out: np.ndarray) -> Problem:
    rows = ~np.isin(part.block, out)
    return Problem(part.A[rows], part.r[rows], part.block[rows], part.offset)


def _stacked(parts: list[Problem], sigma: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """All joints in units of what stays unexplained in each; how many samples count as one."""
    A = np.concatenate([part.A / std for part, std in zip(parts, sigma, strict=True)])
    r = np.concatenate([part.r / std for part, std in zip(parts, sigma, strict=True)])
    return A, r, len(parts[0].A) / max(len(np.unique(parts[0].block)), 1)


def _balanced(parts: list[Problem], unknowns: Unknowns) -> tuple[np.ndarray, np.ndarray]:
    """What stays unexplained in each joint, N m rms, and the estimate with weights to match."""
    sigma = np.array([max(float(np.std(part.r)), FLOOR) for part in parts])
    for _ in range(ROUNDS):
        x, _, _ = solve(*_stacked(parts, sigma), unknowns)
        sigma = np.array([max(float(np.std(p.r - p.A @ x)), FLOOR) for p in parts])
    return sigma, x


def _fit(parts: list[Problem], unknowns: Unknowns) -> tuple[np.ndarray, Fit]:
    sigma, _ = _balanced(parts, unknowns)
    A, r, together = _stacked(parts, sigma)
    return sigma, fit(A, r, np.concatenate([part.block for part in parts]), unknowns, together)


def _unexplained(part: Problem, size: int) -> float:
    """By friction and offset alone, rms."""
    own = part.A[:, size:]
    own = own[:, np.any(own != 0.0, axis=0)]
    return float(np.std(part.r - own @ np.linalg.lstsq(own, part.r, rcond=None)[0]))
