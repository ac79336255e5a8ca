"""The whole chain: law, drives, torque loops, springs and links, with a wrong torque constant."""

from typing import Any

import numpy as np

from limber.experiments.check import Check
from limber.experiments.context import Context
from limber.experiments.pictures import BLUE, ORANGE
from limber.robot import load_robot, read_yaml

from . import bus, classes, ideal
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


def run(context: Context) -> list[Check]:
    checks, loops = [], {}
    for rho in RATIOS:
        context.say(f"inertia ratio {rho:g}")
        checks += stiffness(context, rho)
        loops[rho] = {
            "ideal": ideal.loop(Pose(home(), rho), LOADED, UP_S),
            "bus": bus.loop(context, rho, LOADED, UP_S),
        }
    draw(context, loops)
    return [*checks, *friction(loops), *classes.checks(context)]


def home() -> np.ndarray:
    content = read_yaml(load_robot(ROBOT).folder / "robot.yaml")["joints"]
    return np.array([joint["home_rad"] for joint in content.values()], float)


def stiffness(context: Context, rho: float) -> list[Check]:
    """Against γK, and against what the springs add because their torque is off by γ."""
    rest, felt = bus.stiffness(context, rho)
    made = []
    for where, q, K in (("ideal", home(), ideal.stiffness(Pose(home(), rho))), ("bus", rest, felt)):
        pose = Pose(q, rho)
        C = np.column_stack([pose.moved(axis)[:3] for axis in np.eye(6)[:3]])
        for i, axis in enumerate(AXES):
            name = f"torque constant {KAPPA:g}, inertia ratio {rho:g}, {where}: tip along {axis}"
            measured = float(1 / np.linalg.inv(K)[i, i])
            gamma = share(rho) * K_X[i, i]
            made.append(Check(f"{name}, γK", gamma, measured, "N/m", 0.05))
            made.append(Check(f"{name}, with the springs", 1 / C[i, i], measured, "N/m", 0.01))
    return made


def figures(loop: Loop) -> tuple[float, float]:
    """Width at half load and how far full load moves the tip, mm."""
    force, x = loop
    peak, half = force.max(), len(force) // 2
    down = np.interp(peak / 2, force[:half][::-1], x[:half][::-1])
    up = np.interp(peak / 2, force[half:], x[half:])
    return float(down - up) * 1e3, float(x[-1] - x[half]) * 1e3


def friction(loops: dict[float, dict[str, Loop]]) -> list[Check]:
    made = []
    for rho, ways in loops.items():
        model, seen = figures(ways["ideal"]), figures(ways["bus"])
        name = f"with friction, inertia ratio {rho:g}: "
        made.append(Check(f"{name}width of the loop, bus (prediction: ideal)", model[0], seen[0],
                          "mm", 0.15))  # fmt: skip
        made.append(Check(f"{name}full load moves the tip, bus (prediction: ideal)", model[1],
                          seen[1], "mm", 0.05))  # fmt: skip
    for where in ("ideal", "bus"):
        widths, moves = zip(*(figures(loops[rho][where]) for rho in RATIOS), strict=True)
        wanted = [ideal.PUSH_N / (share(rho) * K_X[1, 1]) * 1e3 for rho in RATIOS]
        short = [w - m for w, m in zip(wanted, moves, strict=True)]
        name = f"what friction leaves with the torque loop over without, {where}: "
        made.append(Check(f"{name}width", 0.6, widths[1] / widths[0], "", 0.0, "at_most"))
        made.append(Check(f"{name}short of the way", 0.6, short[1] / short[0], "", 0.0, "at_most"))
    return made


def draw(context: Context, loops: dict[float, dict[str, Loop]]) -> None:
    with context.picture(TITLE, columns=2, size=(13.0, 5.2)) as axes:
        for ax, where in zip(axes, ("ideal", "bus"), strict=True):
            draw_loops({rho: ways[where] for rho, ways in loops.items()}, ax)
            ax.set_title({"ideal": "Exact sensors, linearised arm",
                          "bus": "Seven drives on the bus"}[where])  # fmt: skip


def draw_loops(loops: dict[float, Loop], ax: Any) -> None:
    for (rho, (force, x)), color in zip(loops.items(), (ORANGE, BLUE), strict=True):
        word = "no torque loop" if rho == 1 else f"torque loop, ratio {rho:g}"
        middle = (x.max() + x.min()) / 2
        ax.plot((x - middle) * 1e3, force, color=color, label=word)
        reach = ideal.PUSH_N / (share(rho) * K_X[1, 1]) / 2 * 1e3
        ax.plot([-reach, reach], [0, ideal.PUSH_N], ":", color=color, label="γK without friction")
    ax.set_xlabel("way of the tip, from the middle (mm)")
    ax.set_ylabel("force along y (N)")
    ax.legend(loc="upper left")
