"""Damping at the motor of an elastic joint under a sampled law, sought by the roots of a cycle."""

from collections.abc import Callable

import numpy as np

from limber_lecture.elastic import PERIOD_S

STABLE_SHARE = 0.5  # of B/(ρT), where a motor under its own late damper becomes unstable
TRIED = 500


def overshoot(ratio: float) -> float:
    """Of a pair of roots with this damping ratio."""
    return float(np.exp(-np.pi * ratio / np.sqrt(1 - ratio**2)))


def damped(
    cycle: Callable[[float], np.ndarray], w: float, ratio: float, most: float
) -> tuple[float, float]:
    """D up to `most`, and the damping ratio with it of the pair of roots that begins near w, rad/s:
    the ratio asked, or the greatest. `cycle`: matrix of one period for a D.
    """
    s, last = complex(0, w), (0.0, -1.0)
    for D in np.linspace(0, most, TRIED):
        roots = np.log(np.linalg.eigvals(cycle(float(D))).astype(complex)) / PERIOD_S
        s = roots[np.argmin(abs(roots - s))]
        found = float(-s.real / abs(s))
        if found >= ratio:
            return float(np.interp(ratio, (last[1], found), (last[0], D))), ratio
        if found < last[1]:
            break
        last = float(D), found
    return last
