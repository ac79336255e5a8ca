"""Impedance against admittance: the same mass, the same delay, opposite limits."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from limber_lecture.context import Comparison, Context, at_least, at_most, case, near_zero
from limber_lecture.pictures import BLUE, MEASURED, ORANGE, name_axes
from limber_lecture.search import limit

from .loops import Admittance, Impedance, implicit_step

TITLE = "Impedance control fails when stiff, admittance control when soft"
CLAIM = "Admittance control is good for being stiff and can become unstable when soft; impedance"
CLAIM += " control is its dual, and becomes unstable when stiff"
SECTION = "1"
PLANT = "mass of 2 kg against a spring, position servo of 15 Hz under the admittance"
FAST = True

m = 2.0
SERVO = m * (2 * math.pi * 15) ** 2
ADMITTANCE = Admittance(m, SERVO, 2 * math.sqrt(SERVO * m), k_e=10e3, t_d=5e-3, M_a=2.0)


WORDS = {
    (60.0, 5.0): "only impedance\nis stable",
    (3e3, 3.5): "both are stable",
    (1.5e5, 8.0): "only admittance\nis stable",
    (1.5e3, 21.0): "neither",
}


def stiffest(t_d: float, zeta: float) -> float:
    """(m/t_d²) x² cos x with cos x = √(4ζ⁴+1) - 2ζ²: phase and gain of the delayed loop at jω."""
    cos_x = math.sqrt(4 * zeta**4 + 1) - 2 * zeta**2
    return m / t_d**2 * math.acos(cos_x) ** 2 * cos_x


def run(context: Context) -> list[Comparison]:
    checks = []
    for zeta in (1.0, 0.7):
        for t_d in (2e-3, 5e-3, 10e-3):
            loop, bound = Impedance(m, zeta, t_d), stiffest(t_d, zeta)
            measured = limit(loop.settles, bound / 10, bound * 10, 1e-5)
            name = f"impedance, {t_d * 1e3:g} ms of delay, damping ratio {zeta:g}: stiffest"
            checks.append(Comparison(name, bound, measured, "N/m", 0.02))
    checks += impedance_in_contact()
    checks += admittance_in_contact()
    for lighter in (0.5, 1.0, 4.0):
        plant = replace(ADMITTANCE, m=lighter)
        measured = limit(lambda M_a, p=plant: not replace(p, M_a=M_a).settles_at_once(), 0.01, 50)
        name = f"admittance without delay, spring and damper: lightest on {lighter:g} kg"
        checks.append(Comparison(name, lighter, measured, "kg", 0.01))
    checks.append(same_filter(context))
    draw(context)
    return checks


def impedance_in_contact() -> list[Comparison]:
    loop = Impedance(m, 1.0, 5e-3, k_e=5000.0)
    bound = limit(loop.is_hurwitz, 100.0, 1e6, 1e-4)
    measured = limit(loop.settles, 100.0, 1e6, 1e-5)
    free = stiffest(5e-3, 1.0)
    return [
        Comparison("impedance against 5 kN/m, 5 ms: stiffest", bound, measured, "N/m", 0.03),
        at_most("the same is below its limit without contact", free, measured, "N/m"),
    ]


def admittance_in_contact() -> list[Comparison]:
    checks, softest = [], []
    for k_e in (2e3, 10e3, 50e3):
        loop = replace(ADMITTANCE, k_e=k_e)
        bound = limit(lambda K, loop=loop: not loop.is_hurwitz(K), 1.0, 1e6, 1e-4)
        softest.append(limit(lambda K, loop=loop: not loop.settles(K), 1.0, 1e6, 1e-5))
        name = f"admittance against {k_e * 1e-3:g} kN/m, 5 ms of delay: softest"
        checks.append(Comparison(name, bound, softest[-1], "N/m", 0.04))
    rise = min(np.diff(softest))
    name = "its softest rises with the stiffness it touches, by"
    return [*checks, at_least(name, 0.0, rise, "N/m")]


def same_filter(context: Context) -> Comparison:
    """The step in loops.py is the one that the controller takes."""
    M, D, K, T = 2.0, 30.0, 400.0, 1e-3
    forces = context.rng.normal(size=300)
    filter_ = {"M": [[M]], "D": [[D]], "K": [[K]], "T": T}
    (answer,) = context.eval([case("admittance_seq", F=forces[:, None], **filter_)])
    state, step = np.zeros(2), implicit_step(M, D, K, T)
    for force in forces:
        state = step @ [*state, force]
    off = abs(np.ravel(answer["x"][-1])[0] - state[0])
    return near_zero("the controller's filter and the one here differ by", off, "m", 1e-12)


def draw(context: Context) -> None:
    delays = np.geomspace(1e-3, 30e-3, 28)
    shown = delays[::3]
    low, high = 10.0, 1e6
    impedance = [Impedance(m, 1.0, t_d, ADMITTANCE.k_e) for t_d in delays]
    admittance = [replace(ADMITTANCE, t_d=t_d) for t_d in delays]
    stiff = [_border(loop.is_hurwitz, low, high) for loop in impedance]
    soft = [_border(lambda K, loop=loop: not loop.is_hurwitz(K), low, high) for loop in admittance]
    with context.picture(TITLE) as ax:
        ms = delays * 1e3
        ax.fill_betweenx(ms, low, stiff, color=BLUE, alpha=0.18, lw=0)
        ax.fill_betweenx(ms, soft, high, color=ORANGE, alpha=0.18, lw=0)
        ax.plot(stiff, ms, color=BLUE, label="impedance is stable left of this")
        ax.plot(soft, ms, color=ORANGE, label="admittance is stable right of this")
        points = [_border(Impedance(m, 1.0, t, ADMITTANCE.k_e).settles, low, high) for t in shown]
        ax.plot(points, shown * 1e3, **MEASURED, color=BLUE)
        loops = [replace(ADMITTANCE, t_d=t_d) for t_d in shown]
        points = [_border(lambda K, loop=loop: not loop.settles(K), low, high) for loop in loops]
        ax.plot(points, shown * 1e3, **MEASURED, color=ORANGE, label="circles: stepped in time")
        ax.set_xscale("log")
        ax.set_yscale("log")
        ax.set_xlim(low, high)
        ax.set_ylim(1, 30)
        ax.set_yticks([1, 2, 5, 10, 20], ["1", "2", "5", "10", "20"])
        for place, words in WORDS.items():
            ax.annotate(words, place, ha="center")
        x_name = "stiffness asked for, in contact with 10 kN/m (N/m)"
        name_axes(ax, x_name, "delay in the loop (ms)", "lower center")


def _border(holds: Callable[[float], bool], low: float, high: float) -> float:
    """Where stability ends, or the end of the axis that it reaches; nothing where there is none."""
    at_low, at_high = holds(low), holds(high)
    if at_low and at_high:
        return high
    return limit(holds, low, high, 1e-3) if at_low else math.nan
