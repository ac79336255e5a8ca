"""Bounded least squares with priors; standard errors and held-out residuals from blocks of time.

    minimise |y - A x|² / (s² T) + sum (x_j / prior_j)²   within  low <= x <= high

s² is the variance of the residual; T samples in a row count as one, because friction, cogging and
model errors change slowly against the sampling. The covariance is that of the delete-one-block
jackknife (Efron, Stein, "The jackknife estimate of variance", 1981), its blocks as long as makes it
largest, and of what the priors leave open:

    cov x = (G - 1)/G sum_b d_b d_bᵀ + H⁻¹ P H⁻¹,   d_b = (H - A_bᵀ A_b/(s² T))⁻¹ A_bᵀ r_b/(s² T)

with H the Hessian, P the part of the priors, r_b the residual of block b of G.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cholesky, solve_triangular
from scipy.linalg import cho_solve as solve_factored
from scipy.optimize import lsq_linear

from limber.arrays import Flags, Floats, Integers

WORST_CONDITION = 1000.0
FLOOR = 1e-4  # no torque is known better, N m; no deflection matters below it, either
ROUNDS = 3
JOINED = (1, 2, 4, 8)  # blocks that may err together
LEAST_BLOCKS = 10
FOLDS = 5


class PoorLogError(Exception):
    """The log does not determine a parameter; the message is the reason."""


@dataclass(frozen=True)
class Fit:
    x: Floats
    covariance: Floats
    residual: Floats

    @property
    def std(self) -> Floats:
        return np.sqrt(np.diag(self.covariance))

    @property
    def rms(self) -> float:
        return float(np.sqrt(np.mean(self.residual**2)))


@dataclass(frozen=True)
class Unknowns:
    """Of a fit, one entry each: how far from 0 they are likely to be, and what is allowed."""

    prior: Floats  # inf: nothing is known
    low: Floats
    high: Floats

    @classmethod
    def free(cls, count: int) -> "Unknowns":
        return cls(np.full(count, np.inf), np.full(count, -np.inf), np.full(count, np.inf))


def fit(
    A: Floats,
    y: Floats,
    block: Integers,
    unknowns: Unknowns | None = None,
    together: float | None = None,
) -> Fit:
    """`together`: how many samples count as one; default: those of a block. Raises PoorLogError if
    columns of A are nearly dependent or blocks are too few.
    """
    unknowns = unknowns or Unknowns.free(A.shape[1])
    flat = np.isinf(unknowns.prior)
    blocks = len(np.unique(block))
    if blocks < 2 * np.count_nonzero(flat) + 2:
        raise PoorLogError(f"too little motion: {blocks} half seconds that count")
    _require_different(A[:, flat])
    x, weight, H = solve(A, y, together or len(y) / blocks, unknowns)
    residual = y - A @ x
    covariance = _covariance(A, residual, block, weight, H, unknowns.prior)
    return Fit(x, covariance, residual)


def unexplained(A: Floats, y: Floats, block: Integers, unknowns: Unknowns) -> float:
    """rms."""
    x, _, _ = solve(A, y, len(y) / len(np.unique(block)), unknowns)
    return float(np.sqrt(np.mean((y - A @ x) ** 2)))


def held_out(
    A: Floats, y: Floats, block: Integers, unknowns: Unknowns, shown: Integers | Flags
) -> Floats:
    """What is left of y by the columns `shown`, each sample by a fit that has not seen its part of
    the recording.
    """
    left = np.empty(len(y))
    for out in folds(block):
        seen = ~out
        together = np.count_nonzero(seen) / len(np.unique(block[seen]))
        x, _, _ = solve(A[seen], y[seen], together, unknowns)
        left[out] = y[out] - A[out][:, shown] @ x[shown]
    return left


def folds(block: Integers) -> Iterator[Flags]:
    """Rows of each of FOLDS parts of the recording, one after the other in time."""
    for part in np.array_split(np.unique(block), FOLDS):
        yield np.isin(block, part)


def _require_different(A: Floats) -> None:
    scale = np.linalg.norm(A, axis=0)
    if not np.all(scale > 0) or not np.linalg.cond(A / scale) <= WORST_CONDITION:
        raise PoorLogError("the motion is too uniform to separate the unknowns")


def solve(
    A: Floats, y: Floats, together: float, unknowns: Unknowns
) -> tuple[Floats, float, Floats]:
    """Estimate, 1/(s² T) and H; s follows from what stays unexplained. `together`: T."""
    x: Floats = np.zeros(A.shape[1])
    gram, moment = A.T @ A, A.T @ y
    prior = np.diag(unknowns.prior**-2.0)
    sigma = max(float(np.std(y)), FLOOR)
    for _ in range(ROUNDS):
        weight = 1.0 / (together * sigma**2)
        H = weight * gram + prior
        x = bounded(H, weight * moment, unknowns.low, unknowns.high)
        sigma = max(float(np.sqrt(np.mean((y - A @ x) ** 2))), FLOOR)
    return x, weight, H


def bounded(H: Floats, h: Floats, low: Floats, high: Floats) -> Floats:
    """The x within bounds that minimises xᵀ H x / 2 - hᵀ x."""
    scale = np.sqrt(np.diag(H))
    try:
        R = cholesky(H / np.outer(scale, scale))
    except np.linalg.LinAlgError as error:
        raise PoorLogError("the motion is too uniform to separate the unknowns") from error
    target = solve_triangular(R, h / scale, trans="T")
    x = solve_triangular(R, target)
    if np.any(x < low * scale) or np.any(x > high * scale):
        x = lsq_linear(R, target, (low * scale, high * scale), method="bvls").x
    return x / scale


def _covariance(
    A: Floats,
    residual: Floats,
    block: Integers,
    weight: float,
    H: Floats,
    prior: Floats,
) -> Floats:
    inverse = np.linalg.inv(H)
    tried = [_jackknife(A, residual, block // length, weight, H) for length in JOINED]
    found = [cov for cov in tried if cov is not None]
    if not found:
        raise PoorLogError("too little motion: its parts cannot be compared with each other")
    scale = np.sqrt(np.diag(inverse))
    largest = max(found, key=lambda cov: float(np.sum(np.diag(cov) / scale**2)))
    covariance: Floats = largest + inverse @ np.diag(prior**-2.0) @ inverse
    return covariance


def _jackknife(
    A: Floats, residual: Floats, group: Integers, weight: float, H: Floats
) -> Floats | None:
    """None if there are too few groups, or one of them alone shows an unknown."""
    order = np.argsort(group, kind="stable")
    A, residual, group = A[order], residual[order], group[order]
    starts = np.flatnonzero(np.diff(group, prepend=group[0] - 1))
    count = len(starts)
    if count < LEAST_BLOCKS:
        return None
    steps = []
    for rows in np.split(np.arange(len(group)), starts[1:]):
        part = A[rows]
        try:
            factor = cho_factor(H - weight * part.T @ part)
        except np.linalg.LinAlgError:
            return None
        steps.append(solve_factored(factor, weight * part.T @ residual[rows]))
    d = np.array(steps)
    covariance: Floats = (count - 1) / count * d.T @ d
    return covariance


def ratio(fitted: Fit, above: tuple[int, ...], below: int) -> tuple[float, float]:
    """Sum of x[above] over x[below] and its standard error, to first order."""
    value = fitted.x[list(above)].sum() / fitted.x[below]
    slope = np.zeros(len(fitted.x))
    slope[list(above)] = 1.0 / fitted.x[below]
    slope[below] -= value / fitted.x[below]
    return float(value), float(np.sqrt(slope @ fitted.covariance @ slope))
