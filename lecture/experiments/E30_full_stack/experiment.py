"""The whole chain: law, drives, torque loops, springs and links, with a wrong torque constant."""

import numpy as np

from limber.model.robot import load_robot
from limber_lecture.context import Comparison, Context, at_most
from limber_lecture.pictures import BLUE, ORANGE, Axes, name_axes

from . import bus, classes, ideal, release
from .arm import K_X, KAPPA, ROBOT, Pose, share

TITLE = "Torque loops bring seven elastic joints nearly the stiffness that is asked of them"
CLAIM = "With joint torque sensing the controller upstream mostly gets the torque it asks for"
SECTION = "3.2"
PLANT = "Panda with flexible joints; ideal: linearised, exact sensors; bus: seven CiA 402 drives"
FAST = False

RATIOS = (1.0, 4.0)
AXES = ("x", "y", "z")
LOADED = np.eye(6)[1]
UP_S = 2.0

Loop = tuple[np.ndarray, np.ndarray]


def run(context: Context) -> list[Comparison]:
    checks, loops, released, home = [], {}, {}, load_robot(ROBOT).home
    for rho in RATIOS:
        context.progress(f"inertia ratio {rho:g}")
        checks += stiffness(context, rho)
        released[rho] = release.measure(context, rho)
        checks += release.checks(rho, released[rho])
        loops[rho] = {
            "ideal": ideal.loop(Pose(home, rho), LOADED, UP_S),
            "bus": bus.loop(context, rho, LOADED, UP_S),
        }
    draw(context, loops, released)
    return [*checks, *friction(loops), *classes.checks(context)]


def stiffness(context: Context, rho: float) -> list[Comparison]:
    """Against γK, and against what the springs add because their torque is off by γ."""
    rest, felt = bus.stiffness(context, rho)
    made, home = [], load_robot(ROBOT).home
    for where, q, K in (("ideal", home, ideal.stiffness(Pose(home, rho))), ("bus", rest, felt)):
        pose = Pose(q, rho)
        C = np.column_stack([pose.moved(axis)[:3] for axis in np.eye(6)[:3]])
        for i, axis in enumerate(AXES):
            name = f"torque constant {KAPPA:g}, inertia ratio {rho:g}, {where}: tip along {axis}"
            measured = float(1 / np.linalg.inv(K)[i, i])
            gamma = share(rho) * K_X[i, i]
            made.append(Comparison(f"{name}, γK", gamma, measured, "N/m", 0.05))
            made.append(Comparison(f"{name}, with the springs", 1 / C[i, i], measured, "N/m", 0.01))
    return made


def figures(loop: Loop) -> tuple[float, float]:
    """Width at half load and how far full load moves the tip, mm."""
    force, x = loop
    peak, half = force.max(), len(force) // 2
    down = np.interp(peak / 2, force[:half][::-1], x[:half][::-1])
    up = np.interp(peak / 2, force[half:], x[half:])
    return float(down - up) * 1e3, float(x[-1] - x[half]) * 1e3


def friction(loops: dict[float, dict[str, Loop]]) -> list[Comparison]:
    made = []
    for rho, ways in loops.items():
        model, seen = figures(ways["ideal"]), figures(ways["bus"])
        name = f"with friction, inertia ratio {rho:g}: "
        for what, values, share_off in (
            ("width of the loop", (model[0], seen[0]), 0.15),
            ("full load moves the tip", (model[1], seen[1]), 0.05),
        ):
            title = f"{name}{what}, bus (prediction: ideal)"
            made.append(Comparison(title, *values, "mm", share_off))
    for where in ("ideal", "bus"):
        widths, moves = zip(*(figures(loops[rho][where]) for rho in RATIOS), strict=True)
        wanted = [ideal.PUSH_N / (share(rho) * K_X[1, 1]) * 1e3 for rho in RATIOS]
        short = [w - m for w, m in zip(wanted, moves, strict=True)]
        name = f"what friction leaves with the torque loop over without, {where}: "
        made.append(at_most(f"{name}width", 0.6, widths[1] / widths[0]))
        made.append(at_most(f"{name}short of the way", 0.6, short[1] / short[0]))
    return made


def draw(context: Context, loops: dict[float, dict[str, Loop]], released: dict) -> None:
    with context.picture(TITLE, columns=3, size=(18.0, 5.2)) as axes:
        release.draw(RATIOS[-1], released[RATIOS[-1]], axes[2])
        titles = {"ideal": "Exact sensors, linearised arm", "bus": "Seven drives on the bus"}
        for ax, (where, title) in zip(axes[:2], titles.items(), strict=True):
            draw_loops({rho: ways[where] for rho, ways in loops.items()}, ax)
            ax.set_title(title)


def draw_loops(loops: dict[float, Loop], ax: Axes) -> None:
    for (rho, (force, x)), color in zip(loops.items(), (ORANGE, BLUE), strict=True):
        word = "no torque loop" if rho == 1 else f"torque loop, ratio {rho:g}"
        middle = (x.max() + x.min()) / 2
        ax.plot((x - middle) * 1e3, force, color=color, label=word)
        reach = ideal.PUSH_N / (share(rho) * K_X[1, 1]) / 2 * 1e3
        ax.plot([-reach, reach], [0, ideal.PUSH_N], ":", color=color, label="γK without friction")
    name_axes(ax, "way of the tip, from the middle (mm)", "force along y (N)", "upper left")
