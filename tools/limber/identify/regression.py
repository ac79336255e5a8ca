"""Least squares with standard errors that hold when neighbouring samples err together.

Friction, cogging and model errors change slowly against the sampling, so samples are no independent
witnesses. Whole blocks of time are: the covariance of the estimate is the cluster-robust one,

    (AᵀA)⁻¹ (Σ_b A_bᵀ r_b r_bᵀ A_b) (AᵀA)⁻¹ · G / (G - p)

(Liang, Zeger, "Longitudinal data analysis using generalized linear models", 1986), with G blocks
and p unknowns.
"""

from dataclasses import dataclass

import numpy as np

WORST_CONDITION = 1000.0


class PoorLogError(Exception):
    """The log does not determine a parameter; the message is the reason."""


@dataclass(frozen=True)
class Fit:
    x: np.ndarray
    covariance: np.ndarray
    residual: np.ndarray
    blocks: int

    @property
    def std(self) -> np.ndarray:
        return np.sqrt(np.diag(self.covariance))

    @property
    def rms(self) -> float:
        return float(np.sqrt(np.mean(self.residual**2)))


def fit(A: np.ndarray, y: np.ndarray, block: np.ndarray) -> Fit:
    """Raises PoorLogError if columns of A are nearly dependent or blocks are too few."""
    groups = np.unique(block)
    unknowns = A.shape[1]
    if len(groups) < 2 * unknowns + 2:
        raise PoorLogError(f"too little motion: {len(groups)} half seconds that count")
    scale = np.linalg.norm(A, axis=0)
    if not np.all(scale > 0) or not np.linalg.cond(A / scale) <= WORST_CONDITION:
        raise PoorLogError("the motion is too uniform to separate the unknowns")
    normal = np.linalg.inv((A / scale).T @ (A / scale)) / np.outer(scale, scale)
    x = np.linalg.lstsq(A / scale, y, rcond=None)[0] / scale
    residual = y - A @ x
    scores = np.array([A[block == group].T @ residual[block == group] for group in groups])
    meat = scores.T @ scores * len(groups) / (len(groups) - unknowns)
    return Fit(x, normal @ meat @ normal, residual, len(groups))


def ratio(fitted: Fit, above: tuple[int, ...], below: int) -> tuple[float, float]:
    """Sum of x[above] over x[below] and its standard error, to first order."""
    value = fitted.x[list(above)].sum() / fitted.x[below]
    slope = np.zeros(len(fitted.x))
    slope[list(above)] = 1.0 / fitted.x[below]
    slope[below] -= value / fitted.x[below]
    return float(value), float(np.sqrt(slope @ fitted.covariance @ slope))
