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

    @classmethod
    def of(cls, s: complex) -> "Mode":
        """With the root s."""
        return cls(float(abs(s)), float(-s.real / abs(s)))

    @property
    def growth(self) -> float:
        """1/s, of its amplitude; less than zero if it dies out."""
        return -self.zeta * self.omega


def modes_of(M: np.ndarray, D: np.ndarray, K: np.ndarray, count: int) -> list[Mode]:
    """Of M s² + D s + K, slowest first; `count` of them swing."""
    return _swinging(roots_of(M, D, K), count)


def roots_of(M: np.ndarray, D: np.ndarray, K: np.ndarray) -> np.ndarray:
    """All s of det(M s² + D s + K) = 0."""
    n = len(M)
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(M, np.hstack([K, D]))]])
    return np.linalg.eigvals(A)


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


def mode_seen(x: np.ndarray, v: np.ndarray, every: int = 1) -> Mode:
    """The one mode of a free motion sampled at 1 kHz, from each `every`th sample."""
    return modes_seen([np.column_stack([x, v])[::every]], every * 1e-3, 1)[0]


def _swinging(roots: np.ndarray, count: int) -> list[Mode]:
    """One of each conjugate pair."""
    upper = sorted((s for s in roots if s.imag > 1e-3 * abs(s)), key=abs)
    if len(upper) != count:
        raise RunError(f"{len(upper)} modes swing, {count} should")
    return [Mode.of(s) for s in upper]
