"""The same Cartesian gains on a perfect, a real, a flexible and a series elastic joint."""

import numpy as np

from limber_lecture.context import Comparison, Context
from limber_lecture.pictures import BLACK, BLUE, GREEN, MARKS, ORANGE, PINK, Axes, name_axes
from limber_lecture.sampled_damping import overshoot

from . import runs
from .joints import JOINTS, ZETA, Joint, K
from .runs import Seen

TITLE = "The same Cartesian gains on five joints: what was asked, and what a hand gets"
CLAIM = "Motors do not just provide the torque a control law calculates"
SECTION = "3.1"
PLANT = "test bench, one joint; ideal: its equations; bus: a CiA 402 drive with exact sensors"
FAST = False

COLORS = (BLACK, BLUE, ORANGE, GREEN, PINK)
OVERSHOOT = overshoot(ZETA)  # of the damping asked for

Found = dict[str, tuple[Seen, Seen]]


def run(context: Context) -> list[Comparison]:
    found: Found = {}
    for joint in JOINTS:
        context.progress(joint.name)
        found[joint.name] = runs.ideal(joint), runs.bus(context, joint)
    with context.picture(TITLE, 2, 2, size=(13.0, 9.0)) as axes:
        draw_release(found, axes[0, 0])
        bars(found, [joint.stiffness for joint in JOINTS], "stiffness", K, 1, axes[0, 1])
        axes[0, 1].set_xlabel("stiffness felt (N m/rad); bars: formula; dotted: asked")
        bars(found, [joint.lag for joint in JOINTS], "lag", 0.0, 1e3, axes[1, 0])
        axes[1, 0].set_xlabel("behind a moving goal, by friction (mrad); bars: formula")
        bars(found, [joint.sag for joint in JOINTS], "sag", 0.0, 1e3, axes[1, 1])
        axes[1, 1].set_xlabel("sag under 10 N m that the law compensates (mrad); bars: formula")
    return [check for joint in JOINTS for check in checks(joint, *found[joint.name])]


def checks(joint: Joint, ideal: Seen, bus: Seen) -> list[Comparison]:
    made = []
    for where, seen in (("ideal", ideal), ("bus", bus)):
        name = f"{joint.name}, {where}: "
        lags, sags = (joint.lag * 1e3, seen.lag * 1e3), (joint.sag * 1e3, seen.sag * 1e3)
        stiffness = f"{name}stiffness, asked {K:g}"
        made += [
            Comparison(stiffness, joint.stiffness, seen.stiffness, "N m/rad", 0.01),
            Comparison(f"{name}behind a moving goal", *lags, "mrad", 0.02, "absolute"),
            Comparison(f"{name}sag under its weight", *sags, "mrad", 0.1, "absolute"),
        ]
        if joint.design[1] == ZETA:
            told = f"{name}overshoot of a motor as described, asked"
            made.append(Comparison(told, OVERSHOOT, seen.as_told, "", 0.03, "absolute"))
    if joint.design[1] < ZETA:
        told = f"{joint.name}: overshoot of a motor as described, asked {OVERSHOOT:.2f}, bus"
        possible = f"{told} (prediction: ideal, with the greatest ratio there is)"
        made.append(Comparison(possible, ideal.as_told, bus.as_told, "", 0.03, "absolute"))
    name = f"{joint.name}, bus (prediction: ideal): overshoot when let go, asked {OVERSHOOT:.2f}"
    return [*made, Comparison(name, ideal.overshoot, bus.overshoot, "", 0.05)]


def draw_release(found: Found, ax: Axes) -> None:
    for (name, (_, seen)), color in zip(found.items(), COLORS, strict=True):
        label = f"{name}: {100 * seen.overshoot:.0f} % ({100 * seen.as_told:.0f} %)"
        ax.plot(seen.t, seen.q * 1e3, color=color, label=label)
    asked = f"{100 * OVERSHOOT:.0f} % asked"
    ax.set_title(f"Let go on the bus: overshoot (without friction), {asked}")
    ax.set_xlim(0, 1.0)
    name_axes(ax, "time (s)", "angle of the link (mrad)", "upper right")


def bars(
    found: Found, formula: list[float], name: str, asked: float, scale: float, ax: Axes
) -> None:
    """A bar is the formula; cross: ideal, circle: bus."""
    rows = np.arange(len(found))[::-1]
    ax.barh(rows, scale * np.array(formula), 0.55, color=COLORS, alpha=0.3)
    for i, (where, style) in enumerate(MARKS.items()):
        values = [scale * getattr(pair[i], name) for pair in found.values()]
        ax.plot(values, rows, **style, color="0.15", label=where)
    if asked:
        ax.axvline(asked, color="0.4", ls=":", lw=1.4)
        ax.set_xlim(0, 1.3 * asked)
    ax.set_yticks(rows, list(found))
    ax.set_ylim(-0.6, len(found) - 0.4)
    ax.legend(loc="lower right" if asked else "upper right")
