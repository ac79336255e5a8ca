"""How far another inertia can be asked for, on one mass: acceleration and force feedback."""

import math

import numpy as np

from limber_lecture.context import Comparison
from limber_lecture.pictures import BLUE, MEASURED, ORANGE, Axes, level, name_axes
from limber_lecture.plants import growth, held, mass, with_delay
from limber_lecture.search import limit

m, T = 2.0, 1e-3
k_e, b_e = 2000.0, 1.0  # what is touched
FILTER_S = 5e-3


def most_inertia(p: float) -> float:
    """m (1+p)/(1-p): the sampled loop a⁺ = p a - (1-p) a M_x/m reaches -1."""
    return m * (1 + p) / (1 - p)


def most_reduction(t_d: float) -> float:
    """1/(1 - b_e/(k_e t_d)): what delay takes of the damping exceeds what the contact has."""
    return 1 / (1 - b_e / (k_e * t_d))


def checks() -> list[Comparison]:
    p = math.exp(-T / FILTER_S)
    found = []
    for name, pole in (("unfiltered", 0.0), ("with a filter of 5 ms", p)):
        added = limit(lambda M_x, pole=pole: _settles(M_x, pole), 0.1, 1e3)
        title = f"acceleration feedback, {name}: most added"
        found.append(Comparison(title, most_inertia(pole), added, "kg", 0.02))
    taken = limit(lambda M_x: _settles(-M_x, p), 0.1, 1e3)
    name = "acceleration feedback, with a filter of 5 ms: most taken away"
    found.append(Comparison(name, m, taken, "kg", 0.02))
    for t_d in (1.5e-3, 2.5e-3):
        name = f"force feedback with {t_d * 1e3:g} ms of delay: most reduction of the inertia"
        found.append(Comparison(name, most_reduction(t_d), _reduction(t_d), "", 0.05))
    return found


def _settles(M_x: float, pole: float) -> bool:
    """F = -M_x a, a filtered with `pole` and read just before F changes; a soft spring to ground.

    State (x, ẋ, a, F).
    """
    b, k = 0.1, 0.05
    A, B = held(*mass(m, b, k), T)
    now = np.zeros((3, 4))
    now[:2, :2], now[:2, 3:] = A, B
    measured = (np.array([0.0, 0.0, 0.0, 1.0]) - k * now[0] - b * now[1]) / m
    now[2] = (1 - pole) * measured
    now[2, 2] += pole
    return growth(np.vstack([now, -M_x * now[2]])) < 1.0


def _reduction(t_d: float) -> float:
    """Largest ρ for which m ẍ = F_e + (ρ-1) F_e(t - t_d), F_e = -k_e x - b_e ẋ, dies out."""
    samples = 60
    h = t_d / (samples + 0.5)  # the hold adds half a step
    A, B = with_delay(*held(*mass(m, b_e, k_e), h), samples)
    contact = np.zeros((1, len(A)))
    contact[0, :2] = -k_e, -b_e
    return limit(lambda rho: growth(A + (rho - 1) * B @ contact) < 1.0, 1.001, 50.0)


def draw(left: Axes, right: Axes) -> None:
    filters = np.linspace(0.2e-3, 10e-3, 60)
    some = np.linspace(1e-3, 10e-3, 7)
    most = [most_inertia(math.exp(-T / tau)) / m for tau in filters]
    left.plot(filters * 1e3, most, color=BLUE, label="(1 + p)/(1 - p)")
    poles = [math.exp(-T / tau) for tau in some]
    points = [limit(lambda M, p=p: _settles(M, p), 0.1, 1e3) / m for p in poles]
    left.plot(some * 1e3, points, **MEASURED, color=BLUE, label="found by trying")
    level(left, "unfiltered: no more than the tip's own", (10, 1), (0, 3), ha="right")
    left.set_title("Acceleration feedback: a slower filter allows more")
    left.set_ylim(bottom=0)
    name_axes(
        left,
        "filter on the acceleration (ms), at 1 kHz",
        "most inertia added over own",
        "upper left",
    )

    delays = np.linspace(0.7e-3, 5e-3, 80)
    bound = [most_reduction(t_d) for t_d in delays]
    right.plot(delays * 1e3, bound, color=ORANGE, label="1/(1 - b/(k t))")
    some = np.linspace(0.8e-3, 4.8e-3, 9)
    points = [_reduction(t_d) for t_d in some]
    right.plot(some * 1e3, points, **MEASURED, color=ORANGE, label="found by trying")
    level(right, "own inertia", (4.9, 1), (0, -10), ha="right")
    right.set_title("Force feedback: delay leaves little to take away")
    right.set_ylim(0.8, 4)
    name_axes(
        right,
        "delay of the measured force (ms)",
        "own inertia over the lightest shown",
        "upper right",
    )
