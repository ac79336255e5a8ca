"""What the controller's velocity estimators make of noise, of delay, of an encoder's counts."""

import math

import numpy as np
from scipy.linalg import solve_discrete_are

from limber_lecture.context import Comparison, Context, case
from limber_lecture.search import order

T, CUTOFF = 1e-3, 2 * math.pi * 30  # s, rad/s
SIGMA_A, SIGMA_X = 8.0, 1.1e-4  # assumed acceleration, m/s², and position noise, m
NO_FILTER = 1e9


def estimate(
    context: Context, x: np.ndarray, cutoff: float = CUTOFF, L: float = 1.0, step: float = T
) -> dict:
    """The answers of the filtered difference, the α-β filter and Levant's differentiator."""
    inputs = {"T": step, "wc": cutoff, "sigma_a": SIGMA_A, "sigma_x": SIGMA_X, "L": L, "x": x}
    (answer,) = context.eval([case("velocity_seq", **inputs)])
    return answer


def checks(context: Context) -> list[Comparison]:
    return [*filtered_difference(context), *riccati(context), *levant(context)]


def filtered_difference(context: Context) -> list[Comparison]:
    sigma, a = 1e-4, math.exp(-CUTOFF * T)
    noise = sigma * context.rng.normal(size=100_000)
    rms = float(np.std(estimate(context, noise)["filtered_diff"][100:]))
    predicted = sigma * (1 - a) / T * math.sqrt(2 / (1 + a))
    t, acceleration = np.arange(2000) * T, 3.0
    late = acceleration * t - estimate(context, acceleration * t**2 / 2)["filtered_diff"]
    delay = a * T / (1 - a) + T / 2
    count = 2 * math.pi / 2**14
    counted = count * np.floor(0.02 * t / count)
    jumps = estimate(context, counted, NO_FILTER)["filtered_diff"]
    step = float(np.min(jumps[jumps > 1e-9]))
    return [
        Comparison("filtered difference: noise", predicted, rms, "m/s", 0.03),
        Comparison("filtered difference: delay", delay, float(late[-1]) / acceleration, "s", 0.01),
        Comparison("plain difference: one count of 14 bits", count / T, step, "rad/s", 1e-6),
    ]


def riccati(context: Context) -> list[Comparison]:
    """The α-β filter is the steady Kalman filter: its gains solve the Riccati equation."""
    A, C = np.array([[1.0, T], [0.0, 1.0]]), np.array([[1.0, 0.0]])
    push = np.array([[T**2 / 2], [T]])
    P = solve_discrete_are(A.T, C.T, SIGMA_A**2 * push @ push.T, np.array([[SIGMA_X**2]]))
    gain = (P @ C.T / (C @ P @ C.T + SIGMA_X**2))[:, 0]
    answer = estimate(context, np.zeros(10))
    return [
        Comparison("α of the α-β filter", gain[0], answer["alpha"], "", 1e-5),
        Comparison("β of the α-β filter", float(gain[1]) * T, answer["beta"], "", 1e-5),
    ]


def levant(context: Context) -> list[Comparison]:
    """Error of order T without noise, of order √ε with noise of size ε."""
    steps = np.array([0.25e-3, 0.5e-3, 1e-3, 2e-3])
    quiet = [levant_error(context, step, 0.0) for step in steps]
    noises = np.array([1e-5, 1e-4, 1e-3])
    noisy = [levant_error(context, 1e-4, noise) for noise in noises]
    return [
        Comparison(
            "Levant: order of the error in T", 1.0, order(steps, quiet), "", 0.15, "absolute"
        ),
        Comparison("Levant: order in the noise", 0.5, order(noises, noisy), "", 0.1, "absolute"),
    ]


def levant_error(context: Context, step: float, noise: float) -> float:
    """Greatest error of the velocity of a sine once it has been caught, m/s."""
    omega, t = 2 * math.pi, np.arange(0.0, 4.0, step)
    x = 0.1 * np.sin(omega * t) + noise * context.rng.uniform(-1, 1, len(t))
    found = estimate(context, x, L=1.1 * 0.1 * omega**2, step=step)["levant"]
    return float(np.max(np.abs(found - 0.1 * omega * np.cos(omega * t))[len(t) // 2 :]))
