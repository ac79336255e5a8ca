"""Masses and centres of mass that explain the torques of slow motion.

Gravity's torque is linear in mass and mass times centre of each body, g(q) = Y(q) pi, but the
joints see some combinations only (Gautier, Khalil, "Direct calculation of minimum set of inertial
parameters of serial robots", 1990). Estimated is the change of pi that explains the torques and
lies nearest to the URDF, which serves as the prior of a Bayesian least-squares estimate: what
gravity does not show stays as it was. Friction and a constant offset of each joint are estimated
along with it.
"""

from dataclasses import dataclass

import numpy as np

from limber.identify.arm import Arm
from limber.identify.motion import Motion

MASS_SHARE = 0.3  # standard deviation of a mass of the URDF,
CENTRE_M = 0.05  # and of a centre of mass
MEASURED = 0.3  # of that deviation: combinations known better than this count as measured
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


def estimate(
    arm: Arm, motion: Motion, Y: np.ndarray, excess: np.ndarray, used: list[int]
) -> Weights:
    """`Y`: gravity_regressor(); `excess`: torque at the joints beyond the model's, N x n."""
    prior = prior_std(arm)
    problems = [_problem(motion, Y, excess, used, k) for k in range(len(used))]
    sigma = [max(float(np.std(problem.r)), FLOOR_NM) for problem in problems]
    before = [problem.unexplained(len(prior)) for problem in problems]
    for _ in range(ROUNDS):  # the weight of each joint follows from what stays unexplained in it
        x, covariance = _solve(problems, sigma, prior)
        sigma = [max(float(np.std(p.r - p.A @ x)), FLOOR_NM) for p in problems]
    size = len(prior)
    changes = covariance[:size, :size]
    return Weights(
        x[:size],
        changes,
        int(np.count_nonzero(np.linalg.eigvalsh(changes / np.outer(prior, prior)) < MEASURED**2)),
        x[size:].reshape(-1, 3),
        np.sqrt(np.diag(covariance))[size + 2 :: 3],
        np.array(before),
        np.array(sigma),
    )


@dataclass(frozen=True)
class _Problem:
    """A x = r of one joint; that many samples of it count as one."""

    A: np.ndarray
    r: np.ndarray
    together: float

    def unexplained(self, size: int) -> float:
        """By friction and offset alone, the columns from `size` on, rms."""
        own = self.A[:, size:]
        return float(np.std(self.r - own @ np.linalg.lstsq(own, self.r, rcond=None)[0]))


def _problem(
    motion: Motion, Y: np.ndarray, excess: np.ndarray, used: list[int], k: int
) -> _Problem:
    i, size = used[k], Y.shape[2]
    rows = slow(motion, i)
    A = np.zeros((np.count_nonzero(rows), size + 3 * len(used)))
    A[:, :size] = Y[rows, i]
    A[:, size + 3 * k : size + 3 * k + 3] = own_terms(motion, i)
    return _Problem(A, excess[rows, i], len(A) / len(np.unique(motion.block[rows])))


def _solve(
    problems: list[_Problem], sigma: list[float], prior: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Friction and offsets have no prior."""
    unknowns = problems[0].A.shape[1]
    H, h = np.zeros((unknowns, unknowns)), np.zeros(unknowns)
    H[range(len(prior)), range(len(prior))] = prior**-2.0
    for problem, std in zip(problems, sigma, strict=True):
        variance = std**2 * problem.together
        H += problem.A.T @ problem.A / variance
        h += problem.A.T @ problem.r / variance
    covariance = np.linalg.inv(H)
    return covariance @ h, covariance


def slow(motion: Motion, i: int) -> np.ndarray:
    """Samples in which joint i moves and no joint speeds up much."""
    return motion.moving[:, i] & (np.abs(motion.a).max(axis=1) < GENTLE)


def own_terms(motion: Motion, i: int) -> np.ndarray:
    """Coulomb and viscous friction and offset of joint i, per unit, in its slow samples."""
    speed = motion.v[slow(motion, i), i]
    return np.stack([np.sign(speed), speed, np.ones_like(speed)], axis=1)


def prior_std(arm: Arm) -> np.ndarray:
    return np.concatenate(
        [
            [body.mass * MASS_SHARE] + 3 * [body.mass * CENTRE_M]
            for body in arm.robot.dynamics.bodies
        ]
    )
