"""A virtual wall on a device with mass m and damping b, sampled at T: how stiff may it be?

The wall is F = -K x - B (x - x₋₁)/T from the sampled position, held until the next sample.
"""

import numpy as np

from limber_lecture.plants import growth, held, mass
from limber_lecture.search import limit

NEUTRAL = 1e-9  # rounding of an eigenvalue that is exactly 1


def loop(T: float, m: float, b: float, K: float, B: float, k_e: float, delay: int) -> np.ndarray:
    """The closed loop over one sample: plant (x, ẋ), then old positions as long as needed.

    `k_e`: spring of a partner that the device is coupled to; `delay`: samples until F acts.
    """
    A, input_gain = held(*mass(m, b, k_e), T)
    memory = delay + 1  # x₋₁ … x₋₍delay+1₎
    closed = np.zeros((2 + memory, 2 + memory))
    closed[:2, :2] = A
    positions = [0, *range(2, 2 + memory)]  # where x, x₋₁, x₋₂, ... are in the state
    closed[:2, positions[delay]] -= input_gain[:, 0] * (K + B / T)
    closed[:2, positions[delay + 1]] += input_gain[:, 0] * B / T
    for i in range(memory):
        closed[2 + i, positions[i]] = 1.0
    return closed


def stiffest(
    T: float, m: float, b: float, B: float = 0.0, k_e: float = 0.0, delay: int = 0
) -> float:
    """Largest stable K, N/m, by trying; 0 if there is none."""

    def stable(K: float) -> bool:
        return growth(loop(T, m, b, K, B, k_e, delay)) <= 1.0 + NEUTRAL

    ceiling = 40.0 * (b + abs(B)) / T + 10.0 * m / T**2
    return limit(stable, 1.0, ceiling) if stable(1.0) else 0.0


def most_damping(T: float, m: float, delay: int) -> float:
    """Largest stable B, N s/m, without wall stiffness and without other damping."""

    def stable(B: float) -> bool:
        return growth(loop(T, m, 0.0, 0.0, B, 0.0, delay)) <= 1.0 + 1e-6

    return limit(stable, 1e-3 * m / T, 10.0 * m / T)


def passive_limit(T: float, b: float, B: float) -> float:
    """Largest K for which the sampled wall draws no energy at any frequency (Colgate, Schenkel).

    b (1 - cos ωT) ≥ T/2 Re{(1 - e^{-jωT}) H(e^{jωT})} for all ω up to the Nyquist frequency, with
    H(z) = K + B (z - 1)/(T z); swept, not solved.
    """
    wT = np.linspace(1e-3, np.pi, 4000)
    back = np.exp(-1j * wT)

    def passive(K: float) -> bool:
        H = K + B * (1.0 - back) / T
        surplus = b * (1.0 - np.cos(wT)) - T / 2 * np.real((1.0 - back) * H)
        return bool(np.all(surplus >= 0.0))

    return limit(passive, 1.0, 100.0 * b / T)
