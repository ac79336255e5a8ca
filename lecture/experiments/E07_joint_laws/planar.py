"""Equations of motion of the planar arm under a joint PD, exact and without sampling."""

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

from limber_lecture import planar2r as arm

Target = Callable[[float], tuple[np.ndarray, np.ndarray]]  # time -> q_d, v_d


def move(
    K: np.ndarray, D: np.ndarray, target: Target, start: np.ndarray, times: np.ndarray
) -> np.ndarray:
    """M q̈ + C q̇ = -K (q - q_d) - D (q̇ - q̇_d) with gravity compensated; q and q̇, a row a time.

    `start` holds q and q̇.
    """

    def slope(t: float, x: np.ndarray) -> np.ndarray:
        q, v = x[:2], x[2:]
        q_d, v_d = target(t)
        tau = -K * (q - q_d) - D * (v - v_d) - arm.coriolis(q, v)
        return np.concatenate([v, np.linalg.solve(arm.inertia(q), tau)])

    found = solve_ivp(slope, (times[0], times[-1]), start, t_eval=times, rtol=1e-9, atol=1e-11)
    return found.y.T


def resting(q_d: np.ndarray) -> Target:
    return lambda t: (q_d, np.zeros(2))
