"""Reduced plants: one mass, written so that each equation can be read, and exact where linear."""

import math

import numpy as np
from scipy.linalg import expm


def held(A: np.ndarray, B: np.ndarray, T: float) -> tuple[np.ndarray, np.ndarray]:
    """ẋ = A x + B u with u held over T: x⁺ = A_d x + B_d u, exactly."""
    n, m = B.shape
    block = np.zeros((n + m, n + m))
    block[:n, :n], block[:n, n:] = A, B
    exact = expm(block * T)
    return exact[:n, :n], exact[:n, n:]


def mass(m: float, b: float = 0.0, k: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """m ẍ + b ẋ + k x = F with state (x, ẋ) and input F."""
    return np.array([[0.0, 1.0], [-k / m, -b / m]]), np.array([[0.0], [1.0 / m]])


def with_delay(A: np.ndarray, B: np.ndarray, samples: int) -> tuple[np.ndarray, np.ndarray]:
    """The sampled plant x⁺ = A x + B u when u arrives `samples` late; state (x, u₋₁, u₋₂, ...)."""
    if samples == 0:
        return A, B
    n, m = B.shape
    size = n + m * samples
    A_all, B_all = np.zeros((size, size)), np.zeros((size, m))
    A_all[:n, :n], A_all[:n, -m:] = A, B
    A_all[n + m :, n:-m] = np.eye(m * (samples - 1))
    B_all[n : n + m] = np.eye(m)
    return A_all, B_all


def growth(A: np.ndarray) -> float:
    """Largest factor by which a motion of x⁺ = A x grows in one step: stable below 1."""
    return float(np.abs(np.linalg.eigvals(A)).max())


def coulomb_step(
    x: float, v: float, F: float, F_c: float, m: float, T: float
) -> tuple[float, float]:
    """m ẍ = F - F_c sign(ẋ) over T with F held, exactly: the mass may stop and stick or turn."""
    left = T
    while left > 0.0:
        if v == 0.0 and abs(F) <= F_c:
            return x, 0.0
        direction = math.copysign(1.0, v if v != 0.0 else F)
        a = (F - F_c * direction) / m
        stops = -v / a if v * a < 0.0 else math.inf
        step = min(left, stops)
        x += v * step + a * step**2 / 2
        v = 0.0 if stops <= left else v + a * step
        left -= step
    return x, v
