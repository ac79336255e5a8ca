"""What a stiffness that changes with time does to energy, and how a tank bounds it."""

import math

import numpy as np
from scipy.optimize import brentq

from limber_lecture.context import Comparison, Context, at_least, at_most, case, near_zero
from limber_lecture.pictures import ARROW, BLACK, BLUE, MEASURED, ORANGE, name_axes, note
from limber_lecture.search import limit

from . import tank
from .swing import K_IN, K_OUT, half_cycle, m, stepped

TITLE = "A stiffness that changes feeds energy in; a tank keeps it below a ceiling"
CLAIM = "Stiffness can be changed while the arm moves if somebody pays for the energy"
SECTION = "2"
PLANT = "mass of 1 kg on a spring of 100 and 150 N/m"
FAST = True


def run(context: Context) -> list[Comparison]:
    stop = brentq(lambda D: half_cycle(D) - 1, 0.1, 10)
    found = limit(lambda D: stepped(D) > 1, 0.1, 10, 1e-4)
    rule = math.log(K_IN / K_OUT) / (2 * math.pi)
    mean = (m * K_OUT * m * K_IN) ** 0.25  # √(m K) at the mean frequency
    free, safe = tank.swing(with_tank=False), tank.swing(with_tank=True)
    ceiling = K_OUT * safe.x[0] ** 2 / 2 + tank.E_0
    checks = [
        Comparison("growth a half cycle", math.sqrt(K_IN / K_OUT), stepped(0.0), "", 2e-3),
        Comparison("damping that just stops it", stop, found, "N s/m", 0.02),
        Comparison("its ratio, by ln(K₂/K₁)/2π", rule, found / (2 * mean), "", 0.05),
        at_most("energy with a tank", ceiling, max(safe.energy), "J"),
        at_least("energy without, over that ceiling", 2.0, max(free.energy) / ceiling),
        at_least("energy left in the tank", tank.E_MIN, min(safe.E), "J", 1e-9),
        held_spring(),
        *same_tank(context, safe),
    ]
    draw(context, free, safe, ceiling, stop)
    return checks


def held_spring() -> Comparison:
    """Work of -K x, held from sample to sample, on a motion a sin ωt, over one cycle."""
    K, T, a, omega = 1000.0, 1e-3, 0.02, 2 * math.pi * 5
    x = a * np.sin(omega * np.arange(0.0, 1 / 5 + T / 2, T))
    work, formula = np.sum(-K * x[:-1] * np.diff(x)), math.pi / 2 * K * T * a**2 * omega
    return Comparison("a held spring gives a cycle", formula, work, "J", 0.01)


def same_tank(context: Context, run: tank.Run) -> list[Comparison]:
    """The controller's tank, fed with what happened, decides the same."""
    settings = {"E0": tank.E_0, "Emax": tank.E_MAX, "Emin": tank.E_MIN, "share": tank.SHARE}
    # the first is the stiffness at the start
    seen = {
        "K_req": np.array([K_OUT, *run.K_req])[:, None, None],
        "e": np.array([0.0, *run.x])[:, None],
        "V": np.array([0.0, *run.v])[:, None],
    }
    (answer,) = context.eval([case("tank_seq", D=[[tank.D]], T=tank.T, **settings, **seen)])
    K, E = (np.ravel(answer[key])[-len(run.K) :] for key in ("K", "E"))
    stiffness = "the controller's tank gives another stiffness by"
    return [
        near_zero(stiffness, np.abs(K - run.K).max(), "N/m", 1e-8),
        near_zero("and another filling by", np.abs(E - run.E).max(), "J", 1e-10),
    ]


def draw(context: Context, free: tank.Run, safe: tank.Run, ceiling: float, stop: float) -> None:
    with context.picture(TITLE, columns=2, size=(12.5, 5.0)) as (left, right):
        t = np.arange(len(free.energy)) * tank.T
        left.semilogy(t, free.energy, color=ORANGE, label="stiffness as asked for")
        left.semilogy(t, safe.energy, color=BLUE, label="stiffness the tank pays for")
        left.axhline(ceiling, color=BLACK, ls="--", lw=1.2)
        words = "ceiling: energy at the start + first filling"
        note(left, words, (6, ceiling), (0, 3), ha="right", color=BLACK)
        left.set_ylim(1e-2, 1e4)
        left.set_title("Soft on the way out, stiff on the way back")
        name_axes(left, "time (s)", "energy of mass and spring (J)", "upper left")
        D = np.linspace(0.0, 3.0, 60)
        right.plot(D, [half_cycle(d) for d in D], color=BLUE, label="exact solution")
        some = np.linspace(0.0, 3.0, 9)
        points = [stepped(d) for d in some]
        right.plot(some, points, **MEASURED, color=BLUE, label="stepped in time")
        right.axhline(1, color="0.5", lw=1)
        note(right, f"{stop:.2f} N s/m just stops it", (stop, 1), (20, 30), **ARROW)
        right.set_title("Damping against it")
        name_axes(right, "damping (N s/m)", "growth of the amplitude a half cycle", "upper right")
