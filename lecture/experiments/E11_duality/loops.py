"""Two ways to make a mass compliant, under delay: loops to count roots of and to step in time."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from limber_lecture.plants import growth, held, mass, with_delay

DELAY_SAMPLES = 60  # the step is chosen so that delay and hold, half a step, make up t_d


def unstable_roots(f: Callable[[np.ndarray], np.ndarray], degree: int, fastest: float) -> int:
    """Right half-plane roots of f(s) = s^degree + ... with delayed lower terms (Mikhailov).

    Along s = jω the phase of f turns by degree·π/2 - N·π; `fastest`, rad/s, is beyond all roots.
    """
    omega = np.concatenate(([0.0], np.geomspace(1e-3 * fastest, 100.0 * fastest, 10001)))
    phase = np.unwrap(np.angle(f(1j * omega)))
    return round(degree / 2 - (phase[-1] - phase[0]) / math.pi)


@dataclass(frozen=True)
class Impedance:
    """m ẍ + k_e x = -[K x + D ẋ] t_d later, D = 2ζ√(K m)."""

    m: float
    zeta: float
    t_d: float
    k_e: float = 0.0

    def is_hurwitz(self, K: float) -> bool:
        D = 2 * self.zeta * math.sqrt(K * self.m)

        def f(s: np.ndarray) -> np.ndarray:
            return self.m * s * s + (D * s + K) * np.exp(-s * self.t_d) + self.k_e

        fastest = D / self.m + math.sqrt((K + self.k_e) / self.m)
        return unstable_roots(f, 2, fastest) == 0

    def settles(self, K: float) -> bool:
        """The same stepped in time."""
        h = self.t_d / (DELAY_SAMPLES + 0.5)
        A, B = with_delay(*held(*mass(self.m, 0.0, self.k_e), h), DELAY_SAMPLES)
        gains = np.zeros((1, len(A)))
        gains[0, :2] = K, 2 * self.zeta * math.sqrt(K * self.m)
        return growth(A - B @ gains) < 1.0


@dataclass(frozen=True)
class Admittance:
    """A servo m ẍ = K_i (x_c - x) + D_i (ẋ_c - ẋ) - k_e x follows M_a ẍ_c + D_a ẋ_c + K_a x_c = F,
    with F the contact force t_d ago.
    """

    m: float
    K_i: float
    D_i: float
    k_e: float
    t_d: float
    M_a: float

    def is_hurwitz(self, K_a: float) -> bool:
        D_a = 2 * math.sqrt(K_a * self.M_a)
        m, K_i, D_i, k_e, M_a = self.m, self.K_i, self.D_i, self.k_e, self.M_a

        def f(s: np.ndarray) -> np.ndarray:
            servo, filter_ = m * s * s + D_i * s + K_i, M_a * s * s + D_a * s + K_a
            return (servo + k_e) * filter_ + (K_i + D_i * s) * k_e * np.exp(-s * self.t_d)

        fastest = D_i / m + D_a / M_a + math.sqrt((K_i + k_e) / m + K_a / M_a)
        return unstable_roots(f, 4, fastest) == 0

    def settles(self, K_a: float) -> bool:
        """The same stepped in time, with the controller's implicit step for the virtual mass."""
        h = self.t_d / (DELAY_SAMPLES + 0.5)
        A, B = self._servo(h)
        step = implicit_step(self.M_a, 2 * math.sqrt(K_a * self.M_a), K_a, h)
        return growth(self._closed(A, B, step)) < 1.0

    def _servo(self, h: float) -> tuple[np.ndarray, np.ndarray]:
        """State (x, ẋ), inputs (x_c, ẋ_c)."""
        A, _ = mass(self.m, self.D_i, self.K_i + self.k_e)
        return held(A, np.array([[0.0, 0.0], [self.K_i / self.m, self.D_i / self.m]]), h)

    def _closed(self, A: np.ndarray, B: np.ndarray, step: np.ndarray) -> np.ndarray:
        """State (x, ẋ, x_c, ẋ_c, old forces). The filter moves first, then the servo follows."""
        n = 4 + DELAY_SAMPLES
        filter_rows = np.zeros((2, n))
        filter_rows[:, 2:4] = step[:, :2]
        filter_rows[:, -1] = step[:, 2]
        closed = np.zeros((n, n))
        closed[2:4] = filter_rows
        closed[:2] = B @ filter_rows
        closed[:2, :2] += A
        closed[4, 0] = -self.k_e
        closed[5:, 4:-1] = np.eye(DELAY_SAMPLES - 1)
        return closed

    def settles_at_once(self) -> bool:
        """Without delay, spring and damping of the filter, in continuous time."""
        m, k_e = self.m, self.k_e
        A = np.zeros((4, 4))
        A[0, 1] = A[2, 3] = 1.0
        A[1] = np.array([-self.K_i - k_e, -self.D_i, self.K_i, self.D_i]) / m
        A[3, 0] = -k_e / self.M_a
        return growth(expm(A * 1e-3)) < 1.0


def implicit_step(M: float, D: float, K: float, T: float) -> np.ndarray:
    """(x, v, F) -> (x⁺, v⁺) of v⁺ = (M v + T (F - K x))/(M + T D + T² K), x⁺ = x + T v⁺."""
    velocity = np.array([-T * K, M, T]) / (M + T * D + T * T * K)
    return np.array([[1.0, 0.0, 0.0] + T * velocity, velocity])
