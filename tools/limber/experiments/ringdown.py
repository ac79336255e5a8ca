"""Modes of an arm that has been let go, from its motion alone; and what sampling makes of them."""

from dataclasses import dataclass

import numpy as np

from limber.errors import RunError

# At 1 kHz: half a period because torques are held, a whole one because they come a cycle late.
# Delay turns a damping D into D - K t.
DELAY_S = 1.5e-3


@dataclass(frozen=True)
class Mode:
    omega: float  # rad/s, magnitude of the root
    zeta: float


def modes_of(M: np.ndarray, D: np.ndarray, K: np.ndarray, count: int) -> list[Mode]:
    """Of M s² + D s + K, slowest first; `count` of them swing."""
    n = len(M)
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(M, np.hstack([K, D]))]])
    return _swinging(np.linalg.eigvals(A), count)


def modes_seen(tracks: list[np.ndarray], step_s: float, count: int) -> list[Mode]:
    """From free motions: x(t + h) = exp(A h) x(t) + b by least squares over all of them.

    One row a sample, positions and velocities.
    """
    before = np.vstack([track[:-1] for track in tracks])
    after = np.vstack([track[1:] for track in tracks])
    middle, scale = before.mean(axis=0), before.std(axis=0)
    known = np.column_stack([(before - middle) / scale, np.ones(len(before))])
    step = np.linalg.lstsq(known, (after - middle) / scale, rcond=None)[0][:-1]
    return _swinging(np.log(np.linalg.eigvals(step).astype(complex)) / step_s, count)


def _swinging(roots: np.ndarray, count: int) -> list[Mode]:
    """One of each conjugate pair."""
    upper = sorted((s for s in roots if s.imag > 1e-3 * abs(s)), key=abs)
    if len(upper) != count:
        raise RunError(f"{len(upper)} modes swing, {count} should")
    return [Mode(float(abs(s)), float(-s.real / abs(s))) for s in upper]
