"""Formulas, and the same on the joint's equations: exact sensors, no bus."""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from limber_lecture import testbench as bench
from limber_lecture.plants import coulomb_step, growth
from limber_lecture.search import limit

from .law import COULOMB_NM, GRAVITY, HYDRAULIC, INERTIA, KAPPA, PUSH_NM, VOLTAGE_D

FINE_S = 1e-5
RAMP_RAD_S = 0.2


def deflection(K: float) -> float:
    """Predicted: τ/(κK)."""
    return PUSH_NM / (KAPPA * K)


def deflection_model(K: float, D: float) -> float:
    return bench.at_rest(bench.rigid(INERTIA), [KAPPA * K, KAPPA * D], PUSH_NM)[0]


def sag(K: float, q_d: float) -> float:
    """Predicted: (1-κ) g/(κK), at the angle that it leads to."""

    def left(q: float) -> float:
        return KAPPA * K * (q_d - q) - (1 - KAPPA) * bench.weight(q, GRAVITY)

    return q_d - brentq(left, q_d - 1, q_d + 1)


def sag_model(K: float, D: float, q_d: float) -> float:
    """Let go at q_d, until it rests."""

    def rate(_: float, x: np.ndarray) -> list[float]:
        weight = bench.weight(x[0], GRAVITY)
        tau = KAPPA * (weight - K * (x[0] - q_d) - D * x[1])
        return [x[1], (tau - weight) / INERTIA]

    return q_d - solve_ivp(rate, (0, 5), [q_d, 0], rtol=1e-9, atol=1e-12).y[0, -1]


def friction_lag_model(K: float, D: float) -> float:
    """Behind a ramp; predicted F_c/K."""
    q = v = 0.0
    T = 1e-4
    for k in range(round(2 / T)):
        tau = K * (RAMP_RAD_S * k * T - q) + D * (RAMP_RAD_S - v)
        q, v = coulomb_step(q, v, tau, COULOMB_NM, INERTIA, T)
    return RAMP_RAD_S * 2 - q


def most_stiffness(D: float, lag: float, T: float = FINE_S, late: int = 0) -> float:
    """Found by trying: K for which the joint behind a lagging torque no longer comes to rest."""
    return _limit(bench.lagging(bench.rigid(INERTIA), lag), D, T, late)


def most_stiffness_hydraulic(D: float, T: float = FINE_S, late: int = 0) -> float:
    return _limit(hydraulic(), D, T, late)


def _limit(plant: bench.Plant, D: float, T: float, late: int) -> float:
    def settles(K: float) -> bool:
        return growth(bench.looped(plant, [K, D], T, late)) < 1.0

    return limit(settles, 50.0, 1e5)


def hydraulic() -> bench.Plant:
    """The cylinder takes its own speed back from the torque, through the same lag."""
    A, inputs = bench.lagging(bench.rigid(INERTIA), HYDRAULIC.lag)
    A[2, 1] = -HYDRAULIC.damping / HYDRAULIC.lag
    return A, inputs


def winding() -> bench.Plant:
    """Voltage R u/k_t on R and a little L, back EMF k_e q̇; state (q, q̇, k_t i)."""
    electric = 1e-5  # s, L/R
    A, inputs = bench.lagging(bench.rigid(INERTIA), electric)
    A[2, 1] = -VOLTAGE_D / electric
    return A, inputs
