"""The same swing under a sampled controller, with and without an energy tank."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from limber_lecture.plants import held, mass

from .swing import K_IN, K_OUT, m

T, D = 1e-3, 0.4  # s, N s/m
E_0, E_MAX, E_MIN, SHARE = 0.5, 2.0, 0.05, 0.8


@dataclass
class Tank:
    """Raising K by ΔK at x costs ½ x ΔK x, which has to be in the tank (Ferraguti 2013)."""

    K: float
    E: float = E_0

    def update(self, K_req: float, x: float, v: float) -> float:
        cost = (K_req - self.K) * x * x / 2
        self.E = min(E_MAX, self.E + SHARE * T * D * v * v)
        if cost <= 0:
            self.K = K_req
            return self.K
        part = min(1.0, (self.E - E_MIN) / cost)
        self.K += part * (K_req - self.K)
        self.E -= part * cost
        return self.K


class Run(NamedTuple):
    """One value a sample each; `energy` of mass and spring."""

    K_req: np.ndarray
    K: np.ndarray
    E: np.ndarray
    x: np.ndarray
    v: np.ndarray
    energy: np.ndarray


def swing(with_tank: bool, seconds: float = 6.0) -> Run:
    """F = -K x - D ẋ, held over T; K_req is chosen to do harm."""
    A, B = held(*mass(m), T)
    state, tank, rows = np.array([0.1, 0.0]), Tank(K_OUT), []
    for _ in range(round(seconds / T)):
        x, v = float(state[0]), float(state[1])
        K_req = K_OUT if x * v > 0 else K_IN
        K = tank.update(K_req, x, v) if with_tank else K_req
        rows.append((K_req, K, tank.E, x, v, (m * v * v + K * x * x) / 2))
        state = A @ state - B[:, 0] * (K * x + D * v)
    return Run(*np.array(rows).T)
