"""Eq. 7 multiplies a tangent by a finite angle: what that costs, and what helps."""

import numpy as np

from limber_lecture.context import Comparison, Context
from limber_lecture.pictures import ARROW, MEASURED, Axes, name_axes, note

from . import snap, statics
from .equilibria import carried, closed_curve
from .laws import COLOR, DIRECT, ORDERS, K, name

TITLE = "Far from the target, the second term of Eq. 4 makes Eq. 7 worse, not better"
CLAIM = "Leaving out the second term of Eq. 4 leads to errors in the stiffness at large deviations"
SECTION = "2"
PLANT = "the controller's laws on planar2r, statics; planar2r pushed, exact equations"
FAST = False


def run(context: Context) -> list[Comparison]:
    checks = statics.checks(context)
    pushed = snap.runs(context)
    with context.picture(TITLE, columns=3, size=(17.5, 5.4)) as (left, middle, right):
        draw_errors(context, left)
        draw_forces(context, middle)
        snap.draw(pushed, right)
    return [*checks, *snap.checks(pushed)]


def draw_errors(context: Context, ax: Axes) -> None:
    away = np.geomspace(0.005, 0.15, 9)
    for form, order in ORDERS.items():
        errors = statics.force_errors(context, form, away) * 100
        ax.loglog(away * 100, errors, **MEASURED, color=COLOR[form])
        line = errors[0] * (away / away[0]) ** order
        ax.loglog(away * 100, line, color=COLOR[form], label=f"{name(form)}: slope {order}")
    ax.set_title("Error of the force at the tip; the direct law makes none")
    ax.set_xticks([0.5, 1, 2, 5, 10], ["0.5", "1", "2", "5", "10"])
    name_axes(ax, "deviation (cm)", "error of the force (%)", "lower right")


def draw_forces(context: Context, ax: Axes) -> None:
    for form in (DIRECT, ("first", "current"), ("full", "mid"), ("full", "current")):
        deviation, load = closed_curve(form, 0.14).T
        style = "--" if form == DIRECT else "-"
        ax.plot(deviation * 100, load, style, color=COLOR[form], label=name(form))
    top = load.max()
    deviation, load = carried(context, form, 1.2 * top).T
    ax.plot(deviation * 100, load, **MEASURED, color=COLOR[form], label="found by Newton")
    beyond = f"beyond {top:.0f} N it finds no rest:\nthe elbow snaps through"
    note(ax, beyond, (deviation[-1] * 100, load[-1]), (-25, -50), **ARROW)
    ax.set_title(f"Load on the tip; asked for {K[0, 0]:.0f} N/m")
    ax.set_ylim(0, 50)
    name_axes(ax, "deviation along the load (cm)", "load (N)", "upper left")
