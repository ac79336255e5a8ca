"""What a stiffness that changes with time does to energy, and how a tank bounds it."""

import math

import numpy as np
from scipy.optimize import brentq

from limber.experiments.check import Check
from limber.experiments.context import Context
from limber.experiments.evaluate import case
from limber.experiments.pictures import BLACK, BLUE, MEASURED, ORANGE
from limber.experiments.search import limit

from . import tank
from .swing import K_IN, K_OUT, half_cycle, m, stepped

TITLE = "A stiffness that changes feeds energy in; a tank keeps it below a ceiling"
CLAIM = "Stiffness can be changed while the arm moves if somebody pays for the energy"
SECTION = "2"
PLANT = "mass of 1 kg on a spring of 100 and 150 N/m"
FAST = True


def run(context: Context) -> list[Check]:
    stop = brentq(lambda D: half_cycle(D) - 1, 0.1, 10)
    found = limit(lambda D: stepped(D) > 1, 0.1, 10, 1e-4)
    rule = math.log(K_IN / K_OUT) / (2 * math.pi)
    mean = (m * K_OUT * m * K_IN) ** 0.25  # √(m K) at the mean frequency
    free, safe = tank.swing(with_tank=False), tank.swing(with_tank=True)
    ceiling = K_OUT * safe.x[0] ** 2 / 2 + tank.E_0
    checks = [
        Check("growth a half cycle", math.sqrt(K_IN / K_OUT), stepped(0.0), "", 2e-3),
        Check("damping that just stops it", stop, found, "N s/m", 0.02),
        Check("its ratio, by ln(K₂/K₁)/2π", rule, found / (2 * mean), "", 0.05),
        Check("energy with a tank", ceiling, max(safe.energy), "J", 0.0, "at_most"),
        Check(
            "energy without, over that ceiling",
            2.0,
            max(free.energy) / ceiling,
            "",
            0.0,
            "at_least",
        ),
        Check("energy left in the tank", tank.E_MIN, min(safe.E), "J", 1e-9, "at_least"),
        held_spring(),
        *same_tank(context, safe),
    ]
    draw(context, free, safe, ceiling, stop)
    return checks


def held_spring() -> Check:
    """Work of -K x, held from sample to sample, on a motion a sin ωt, over one cycle."""
    K, T, a, omega = 1000.0, 1e-3, 0.02, 2 * math.pi * 5
    x = a * np.sin(omega * np.arange(0.0, 1 / 5 + T / 2, T))
    work = float(np.sum(-K * x[:-1] * np.diff(x)))
    return Check("a held spring gives a cycle", math.pi / 2 * K * T * a**2 * omega, work, "J", 0.01)


def same_tank(context: Context, run: tank.Run) -> list[Check]:
    """The controller's tank, fed with what happened, decides the same."""
    column = {key: np.array(getattr(run, key))[:, None] for key in ("x", "v")}
    settings = {"E0": tank.E_0, "Emax": tank.E_MAX, "Emin": tank.E_MIN, "share": tank.SHARE}
    asked = [K_OUT, *run.K_req]  # the first is the stiffness at the start
    first = np.zeros((1, 1))
    (answer,) = context.eval(
        [
            case(
                "tank_seq",
                **settings,
                D=[[tank.D]],
                T=tank.T,
                K_req=[[[K]] for K in asked],
                e=np.vstack([first, column["x"]]),
                V=np.vstack([first, column["v"]]),
            )
        ]
    )
    K, E = (np.ravel(answer[key])[-len(run.K) :] for key in ("K", "E"))
    off = float(np.max(np.abs(K - run.K))), float(np.max(np.abs(E - run.E)))
    return [
        Check(
            "the controller's tank gives another stiffness by", 0.0, off[0], "N/m", 1e-8, "absolute"
        ),
        Check("and another filling by", 0.0, off[1], "J", 1e-10, "absolute"),
    ]


def draw(context: Context, free: tank.Run, safe: tank.Run, ceiling: float, stop: float) -> None:
    with context.picture(TITLE, columns=2, size=(12.5, 5.0)) as (left, right):
        t = np.arange(len(free.energy)) * tank.T
        left.semilogy(t, free.energy, color=ORANGE, label="stiffness as asked for")
        left.semilogy(t, safe.energy, color=BLUE, label="stiffness the tank pays for")
        left.axhline(ceiling, color=BLACK, ls="--", lw=1.2)
        left.annotate(
            "ceiling: energy at the start + first filling", (6, ceiling * 1.1), ha="right"
        )
        left.set_ylim(1e-2, 1e4)
        left.set_title("Soft on the way out, stiff on the way back")
        left.set_xlabel("time (s)")
        left.set_ylabel("energy of mass and spring (J)")
        left.legend(loc="upper left")
        D = np.linspace(0.0, 3.0, 60)
        right.plot(D, [half_cycle(d) for d in D], color=BLUE, label="exact solution")
        some = np.linspace(0.0, 3.0, 9)
        right.plot(
            some, [stepped(d) for d in some], **MEASURED, color=BLUE, label="stepped in time"
        )
        right.axhline(1, color="0.5", lw=1)
        right.annotate(
            f"{stop:.2f} N s/m just stops it",
            (stop, 1),
            xytext=(20, 30),
            textcoords="offset points",
            arrowprops={"arrowstyle": "->"},
        )
        right.set_title("Damping against it")
        right.set_xlabel("damping (N s/m)")
        right.set_ylabel("growth of the amplitude a half cycle")
        right.legend(loc="upper right")
