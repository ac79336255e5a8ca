"""A wall felt through a coarse encoder: its force jumps at each count, friction has to hold it."""

import math

import numpy as np

from limber_lecture.plants import coulomb_step
from limber_lecture.search import limit

m, F_c, COUNT, T = 0.1, 0.05, 1e-4, 1e-3  # kg, N, m, s


def stiffest_quiet() -> float:
    """2 F_c/Δ: half a jump of the force is what friction can just hold (Abbott, Okamura 2005)."""
    return 2 * F_c / COUNT


def motion(K: float, seconds: float = 3.0) -> np.ndarray:
    """Positions under F = -K x_counted and a push that balances midway between two counts."""
    push = K * COUNT * 3.5
    x, v = 4.2 * COUNT, -2e-4
    positions = []
    for _ in range(round(seconds / T)):
        counted = COUNT * math.floor(x / COUNT)
        x, v = coulomb_step(x, v, push - K * counted, F_c, m, T)
        positions.append(x)
    return np.array(positions)


def hunting(K: float) -> float:
    """Peak-to-peak motion of the last third, m: 0 if it has come to rest."""
    positions = motion(K)
    return float(np.ptp(positions[2 * len(positions) // 3 :]))


def measured_limit() -> float:
    return limit(lambda K: hunting(K) == 0.0, 100.0, 10000.0, 1e-3)
