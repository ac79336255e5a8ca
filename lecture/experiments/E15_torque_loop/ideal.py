"""Torque loop of a drive: formulas, and the same on the joint's equations.

τ_m = ρ u + (1 - ρ)(τ + D τ̇/K_J) with the inertia ratio ρ = B/B_θ.
"""

import numpy as np

from limber_lecture import testbench as bench
from limber_lecture.plants import growth, held
from limber_lecture.search import limit

B, D_J, K_J = bench.B, bench.D_J, bench.K_J
K, D = 100.0, 10.0  # of the law outside, on the motor
FINE_S = 1e-5
SPEED = 0.2  # rad/s


def gained(rho: float, kappa: float) -> float:
    """Torque at rest over what was asked for, torque constant κ."""
    return kappa * rho / (1 + kappa * (rho - 1))


def most_ratio(rate: float, samples: int) -> float:
    """ρ - 1 < D_J/(K_J (T/2 + delay)), sensed torque alone, link held."""
    return 1 + D_J / (K_J * (0.5 + samples) / rate)


def most_ratio_found(rate: float, samples: int) -> float:
    def settles(more: float) -> bool:
        loop = bench.looped(bench.held_link(), [more * K_J, 0.0], 1 / rate, samples)
        return growth(loop) < 1.0

    return 1 + limit(settles, 0.01, 100.0)


def loop_with_rate(rho: float) -> np.ndarray:
    """Link held, τ̇ known exactly, sampled so fast that it does not matter."""
    return bench.looped(bench.held_link(), [(rho - 1) * K_J, (rho - 1) * D_J], FINE_S, 0)


def loop_of_drive(rho: float, rate: float) -> np.ndarray:
    """Link held, τ̇ = (τ - τ₋₁)/T as a drive has it; state (θ, θ̇, τ₋₁)."""
    T = 1 / rate
    A, inputs = bench.held_link()
    A, inputs = held(A, inputs[:, :1], T)
    damper = D_J / (K_J * T)
    row = (1 - rho) * np.array([[K_J * (1 + damper), 0.0, -damper]])
    closed = np.zeros((3, 3))
    closed[:2, :2], closed[2, 0] = A, K_J
    closed[:2] += inputs @ row
    return closed


def at_rest(rho: float, kappa: float = 1.0, bias: float = 0.0, push: float = 0.0) -> float:
    """Motor angle θ under u = -K θ on the free joint; the sensor reads τ + bias."""
    plant, inputs = bench.elastic()
    motor = inputs[:, :1]
    feedback = kappa * (1 - rho) * K_J * np.array([[-1.0, 0.0, 1.0, 0.0]])
    law = kappa * rho * np.array([[0.0, 0.0, -K, -D]])
    constant = motor[:, 0] * kappa * (1 - rho) * bias + inputs[:, 1] * push
    return float(np.linalg.solve(plant + motor @ (feedback + law), -constant)[2])


def friction_lag(rho: float, coulomb: float) -> float:
    """Of the motor behind a ramp, in time; dry friction's sign held over a step."""
    T, seconds = 2e-5, 1.5
    plant, inputs = bench.elastic()
    deflection = np.array([-1.0, 0.0, 1.0, 0.0])
    rate = np.array([0.0, -1.0, 0.0, 1.0])
    feedback = (1 - rho) * (K_J * deflection + D_J * rate)
    A, b = held(plant + inputs[:, :1] @ feedback[None], inputs[:, :1], T)
    x = np.array([0.0, SPEED, 0.0, SPEED])
    for k in range(round(seconds / T)):
        u = K * (SPEED * k * T - x[2]) + D * (SPEED - x[3])
        x = A @ x + b[:, 0] * (rho * u - coulomb * np.sign(x[3]))
    return SPEED * seconds - float(x[2])
