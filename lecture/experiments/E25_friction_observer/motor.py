"""A motor with dry friction that follows a slow ramp, with and without an observer."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from limber_lecture.plants import coulomb_step

B, F_c, L, T = 0.2, 2.0, 20.0, 1e-3  # kg m², N m, 1/s, s
K, D = 100.0, 10.0  # N m/rad, N m s/rad
SPEED = 0.2  # rad/s


@dataclass
class Observer:
    """z⁺ = z + T L (τ_m - τ - τ̂), τ̂ = z - L B θ̇ (the output before the update)."""

    z: float

    def update(self, speed: float, tau_m: float) -> float:
        self.z += T * L * (tau_m - self.output(speed))
        return self.output(speed)

    def output(self, speed: float) -> float:
        return self.z - L * B * speed


class Ramp(NamedTuple):
    """One value a sample each."""

    lag: np.ndarray
    speed: np.ndarray
    tau_m: np.ndarray
    estimate: np.ndarray


def follow(compensated: bool, seconds: float = 2.0) -> Ramp:
    """τ_m = K (θ_d - θ) + D (θ̇_d - θ̇) [+ τ̂] on B θ̈ = τ_m - F_c sign(θ̇)."""
    angle, speed, rows, observer = 0.0, 0.0, [], Observer(0.0)
    for k in range(round(seconds / T)):
        lag = SPEED * k * T - angle
        estimate = observer.output(speed)
        tau_m = K * lag + D * (SPEED - speed) + (estimate if compensated else 0.0)
        rows.append((lag, speed, tau_m, estimate))
        observer.update(speed, tau_m)
        angle, speed = coulomb_step(angle, speed, tau_m, F_c, B, T)
    return Ramp(*np.array(rows).T)


def turning(friction: np.ndarray, tau_m: float = 3.0) -> np.ndarray:
    """Speeds of a motor under a constant torque and a given friction torque, held over T."""
    gained = (tau_m - friction) * T / B
    return 1.0 + np.concatenate(([0.0], np.cumsum(gained)[:-1]))
