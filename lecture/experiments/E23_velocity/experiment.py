"""Velocity from an encoder: what it costs in noise, in delay, and in hunting at a wall."""

import math

import numpy as np

from limber_lecture.context import Comparison, Context
from limber_lecture.pictures import AMBER, BLACK, BLUE, GREEN, MEASURED, ORANGE, SKY, name_axes

from . import hunting
from .estimators import CUTOFF, NO_FILTER, T, checks, estimate

TITLE = "A differentiated encoder is noisy, late or both, and a coarse one makes stiff walls hunt"
CLAIM = "Differentiating an encoder to get a velocity is pretty dicey"
SECTION = "3.2"
PLANT = "the controller's estimators at 1 kHz; a mass of 0.1 kg with dry friction at a wall"
FAST = True


def run(context: Context) -> list[Comparison]:
    found = checks(context)
    bound, measured = hunting.stiffest_quiet(), hunting.measured_limit()
    found.append(Comparison("stiffest wall without hunting", bound, measured, "N/m", 0.05))
    with context.picture(TITLE, columns=2, size=(12.5, 5.0)) as (left, right):
        draw_estimates(context, left)
        draw_hunting(right)
    return found


def draw_estimates(context: Context, ax) -> None:
    t = np.arange(0.0, 1.2, T)
    omega, count = 2 * math.pi * 2, 2 * math.pi / 2**14
    x = count * np.floor(0.05 * np.sin(omega * t) / count)
    L = 1.1 * 0.05 * omega**2
    plain = estimate(context, x, NO_FILTER, L)
    smooth = estimate(context, x, CUTOFF, L)
    shown = slice(round(0.5 / T), round(0.75 / T))
    ms = (t[shown] - 0.5) * 1e3
    ax.plot(ms, plain["filtered_diff"][shown], color=SKY, lw=0.6, label="plain difference")
    ax.plot(ms, smooth["levant"][shown], color=AMBER, lw=1.2, label="Levant's differentiator")
    ax.plot(ms, smooth["filtered_diff"][shown], color=BLUE, label="difference, 30 Hz filter")
    ax.plot(ms, smooth["alpha_beta"][shown], color=GREEN, label="α-β filter")
    ax.plot(ms, 0.05 * omega * np.cos(omega * t[shown]), "--", color=BLACK, label="true")
    ax.set_title("A joint swings by 0.05 rad, seen by 14 bits")
    name_axes(ax, "time (ms)", "velocity (rad/s)")
    ax.set_ylim(-1.2, 2.1)
    ax.legend(loc="upper right", ncols=2)


def draw_hunting(ax) -> None:
    stiffness = np.array([200, 400, 600, 800, 950, 1050, 1200, 1600, 2200, 3200, 4500.0])
    moved = [hunting.hunting(K) * 1e6 for K in stiffness]
    border = hunting.stiffest_quiet()
    ax.axvspan(100, border, color=BLUE, alpha=0.15, lw=0)
    ax.axvline(border, color=BLUE, label="2 × friction / count")
    ax.plot(stiffness, moved, **MEASURED, color=ORANGE, label="motion that does not end")
    ax.annotate("friction holds it", (330, 8.0), color=BLUE)
    ax.set_yscale("symlog", linthresh=1e-2)
    ax.set_ylim(-3e-3, 1e3)
    ax.set_xscale("log")
    ax.minorticks_off()
    ax.set_xlim(150, 6000)
    ticks = [200, 500, 1000, 2000, 5000]
    ax.set_xticks(ticks, [str(tick) for tick in ticks])
    ax.set_title("A wall through counts of 0.1 mm, 0.05 N of friction")
    name_axes(ax, "stiffness of the wall (N/m)", "peak to peak (µm)", "upper left")
