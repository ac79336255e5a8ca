"""How fast a soft arm becomes when it touches something stiff."""

import math

import numpy as np

from limber_lecture.context import Comparison, Context
from limber_lecture.pictures import ARROW, BLUE, MEASURED, ORANGE, name_axes, note
from limber_lecture.plants import held, mass

TITLE = "Contact multiplies a soft arm's bandwidth by the root of the stiffness"
CLAIM = "In contact the bandwidth is multiplied by the stiffness of what is touched: an arm of 1 Hz"
CLAIM += " suddenly has 100 Hz"
SECTION = "3.1"
PLANT = "mass of 1 kg under a sampled spring-damper law of 1 Hz, against a spring"
FAST = True

m, T, T_LOOP = 1.0, 1e-4, 1e-5
K = m * (2 * math.pi) ** 2
ZETA = 0.3
D = 2 * ZETA * math.sqrt(K * m)
GAIN = 2 * math.pi / K  # of the force loop, m/s per N: 1 Hz against a spring of K
TOUCHED = np.array([0.0, 99.0, 9999.0]) * K


def run(context: Context) -> list[Comparison]:
    checks = []
    for k_e, f in zip(TOUCHED, (1.0, 10.0, 100.0), strict=True):
        frequency, zeta = ring_down(k_e)
        against = f"against {k_e / K:g} times its own stiffness"
        checks.append(Comparison(f"frequency {against}", f, frequency, "Hz", 0.01))
        checks.append(Comparison(f"damping ratio {against}", ZETA / f, zeta, "", 0.01))
    for k_e in (K, 10 * K, 100 * K):
        bandwidth = GAIN * k_e / (2 * math.pi)
        name = f"bandwidth of a force loop against {k_e / K:g} times that stiffness"
        checks.append(Comparison(name, bandwidth, force_loop(k_e), "Hz", 0.01))
    F_ff, depth, k_e = 8.0, 0.05, 20 * K
    force = k_e * (F_ff + K * depth) / (K + k_e)
    measured = pressed(F_ff, depth, k_e)
    checks.append(Comparison("contact force with feed-forward", force, measured, "N", 0.01))
    draw(context)
    return checks


def closed_loop(k_e: float) -> tuple[np.ndarray, np.ndarray]:
    """One sample of F = -K x - D ẋ + F_ff, held over T, on the mass against k_e."""
    A, B = held(*mass(m, 0.0, k_e), T)
    return A - B @ np.array([[K, D]]), B


def ring_down(k_e: float) -> tuple[float, float]:
    """Frequency, Hz, and damping ratio of the free motion, fitted to the positions it leaves."""
    A, _ = closed_loop(k_e)
    state, x = np.array([1e-3, 0.0]), []
    stride = round(0.05 / math.sqrt(1 + k_e / K) / T)  # twenty positions a period
    for _ in range(40):
        x.append(state[0])
        state = np.linalg.matrix_power(A, stride) @ state
    return fit(np.array(x), stride * T)


def fit(x: np.ndarray, step: float) -> tuple[float, float]:
    """x₊₂ = a x₊₁ + b x by least squares; its roots are e^{s·step} (Prony)."""
    a, b = np.linalg.lstsq(np.column_stack([x[1:-1], x[:-2]]), x[2:], rcond=None)[0]
    s = np.log(np.roots([1.0, -a, -b]).astype(complex))[0] / step
    return abs(s) / (2 * math.pi), -s.real / abs(s)


def force_loop(k_e: float) -> float:
    """-3 dB frequency of ẋ = g (f_d - k_e x), sampled, from the time its step takes to 63 %."""
    f_d, x, t = 10.0, 0.0, 0.0
    while True:
        before, x = x, x + T_LOOP * GAIN * (f_d - k_e * x)
        goal = f_d / k_e * (1 - math.exp(-1))
        if x >= goal:
            tau = t + T_LOOP * (goal - before) / (x - before)
            return 1 / (2 * math.pi * tau)
        t += T_LOOP


def pressed(F_ff: float, depth: float, k_e: float) -> float:
    """Force at rest on a wall when the target lies `depth` in it."""
    A, B = closed_loop(k_e)
    state = np.zeros(2)
    for _ in range(round(5.0 / T)):
        state = A @ state + B[:, 0] * (F_ff + K * depth)
    return k_e * state[0]


def draw(context: Context) -> None:
    ratio = np.geomspace(0.1, 1e4, 60)
    with context.picture(TITLE) as ax:
        spring = np.sqrt(1 + ratio)
        ax.loglog(ratio, spring, color=BLUE, label="spring law of 1 Hz: √(1 + k/K)")
        stiff = np.geomspace(0.1, 1e3, 9)
        ax.loglog(stiff, [ring_down(r * K)[0] for r in stiff], **MEASURED, color=BLUE)
        ax.loglog(1e4, ring_down(1e4 * K)[0], **MEASURED, color=BLUE, label="its ring-down")
        force = ratio[ratio < 2000]
        ax.loglog(force, force, color=ORANGE, label="force loop of 1 Hz at k = K: k/K")
        some = np.geomspace(0.1, 1000, 9)
        points = [force_loop(r * K) for r in some]
        ax.loglog(some, points, **MEASURED, color=ORANGE, label="its step")
        note(
            ax,
            "10 000 times stiffer:\n100 times faster",
            (1e4, 100),
            (-12, -85),
            ha="right",
            **ARROW,
        )
        x_name = "stiffness touched over stiffness of the law, k/K"
        name_axes(ax, x_name, "bandwidth (Hz)", "upper left")
