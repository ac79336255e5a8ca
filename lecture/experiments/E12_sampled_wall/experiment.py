"""How stiff a wall may be that exists only at the samples of a controller."""

import math

import numpy as np

from limber_lecture.context import Comparison, Context
from limber_lecture.pictures import AMBER, BLACK, BLUE, GREEN, MEASURED, ORANGE, name_axes, note

from . import wall

TITLE = "A sampled wall is passive only up to 2(b - |B|)/T"
CLAIM = "Impedance control becomes unstable as the compliance is decreased: at a rate of 1/T the"
CLAIM += " damping b of the device allows a stiffness of 2b/T, and no more"
SECTION = "1"
PLANT = "mass with damping 5 N s/m, force held for 1 ms"
FAST = True

T, b = 1e-3, 5.0
PARTNERS_KG = np.geomspace(1e-6, 100.0, 33)
PARTNERS_N_PER_M = (0.0, 100.0, 1000.0, 10000.0)


def free_mass_limit(m: float) -> float:
    """b a (1-ε)/(1-ε(1+aT)), a = b/m, ε = e^{-aT}: Jury's test of the sampled loop (Gil 2009)."""
    a = b / m
    eps = math.exp(-a * T)
    return b * a * (1 - eps) / (1 - eps * (1 + a * T))


def run(context: Context) -> list[Comparison]:
    checks = []
    for B in (0.0, 2.0, -2.0):
        bound = 2 * (b - abs(B)) / T
        name = f"stiffest passive wall, B = {B:g} N s/m"
        checks.append(Comparison(name, bound, wall.passive_limit(T, b, B), "N/m", 1e-3))
        worst = min(wall.stiffest(T, m, b, B, k_e) for m in PARTNERS_KG for k_e in PARTNERS_N_PER_M)
        name = f"stiffest wall with the worst partner, B = {B:g} N s/m"
        checks.append(Comparison(name, bound, worst, "N/m", 0.05))
    for m in (0.02, 0.2, 2.0):
        measured = wall.stiffest(T, m, b)
        checks.append(Comparison(f"free {m:g} kg", free_mass_limit(m), measured, "N/m", 1e-4))
    for delay in (0, 1, 3):
        rule = (b + 20.0) / (T / 2 + delay * T)
        measured = wall.stiffest(T, 2.0, b, 20.0, delay=delay)
        name = f"linear rule (b + B)/(T/2 + delay), {delay} ms of delay"
        checks.append(Comparison(name, rule, measured, "N/m", 0.15))
    for delay, factor in ((0, 2.0), (1, 2 * (math.sqrt(2) - 1))):
        measured = wall.most_damping(T, 2.0, delay)
        name = f"most damping on 2 kg, {delay} ms of delay"
        checks.append(Comparison(name, factor * 2.0 / T, measured, "N s/m", 1e-3))
    draw(context)
    return checks


def draw(context: Context) -> None:
    B = np.linspace(-4.9, 4.9, 99)
    sweep = np.linspace(-4.5, 4.5, 13)
    with context.picture("Stiff walls need fast sampling or damping in the device") as ax:
        passive = 2 * (b - np.abs(B)) / T * 1e-3
        ax.fill_between(B, passive, color=BLUE, alpha=0.15, lw=0)
        ax.plot(B, passive, color=BLUE, label="passive below: 2(b - |B|)/T")
        points = [wall.passive_limit(T, b, value) * 1e-3 for value in sweep]
        ax.plot(sweep, points, **MEASURED, color=BLUE, label="frequency sweep")
        for m, color in ((0.002, ORANGE), (0.01, GREEN), (2.0, AMBER)):
            limits = [wall.stiffest(T, m, b, value) * 1e-3 for value in B]
            name = f"stable below, with a mass of {m * 1e3:g} g"
            ax.plot(B, limits, "--", color=color, label=name)
            label = "formula for B = 0" if m == 2.0 else None
            ax.plot(0, free_mass_limit(m) * 1e-3, "s", color=color, label=label)
        note(ax, "safe with every passive partner", (0, 3.2), ha="center", color=BLACK)
        ax.set_ylim(0, 25)
        x_name, y_name = (
            "damping of the virtual wall, B (N s/m)",
            "stiffness of the virtual wall, K",
        )
        name_axes(ax, x_name, f"{y_name} (kN/m)", "upper left")
