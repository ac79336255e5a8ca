"""Two motors and a nonlinear spring a joint: how much of Eq. 4's stiffness they can set."""

import numpy as np

from limber.model.robot import load_robot
from limber_lecture.context import Comparison, Context
from limber_lecture.pictures import BLUE, ORANGE, Axes, name_axes

from . import fit, fit_picture, pair, ring, seven

TITLE = "Two motors a joint set the diagonal of Eq. 4's stiffness, and nothing of its damping"
CLAIM = "Preload of nonlinear springs sets the joint stiffness that Eq. 4 asks for, with two motors"
CLAIM += " a joint"
SECTION = "3.3"
PLANT = "one, two and seven joints with two motors each; ideal: their springs; bus: CiA 402 drives"
FAST = False


def run(context: Context) -> list[Comparison]:
    alone = pair.checks(context)
    rung, placed = ring.found(context), ring.found_under_law(context)
    shares = fit.residuals(context)
    tips, springs = fit.found(context)
    robot = load_robot(seven.ROBOT)
    wrist = seven.asked_of_class(context, context.rng.uniform(-1.2, 1.2, len(robot.joints)))
    arm = seven.on_arm(context)
    with context.picture(TITLE, columns=3, size=(17.5, 5.0)) as (left, middle, right):
        fit_picture.draw_tips(tips, left)
        fit_picture.draw_residual(shares, middle)
        draw_ring(rung, right)
    released = [*ring.checks(rung), *ring.checks_under_law(placed)]
    return [*alone, *released, *fit.checks(tips, springs, shares), *wrist, *arm]


def draw_ring(rung: dict[str, ring.Rung], ax: Axes) -> None:
    run = rung["bus"]
    ax.plot(run.t, 1e3 * run.q, color=BLUE, lw=0.8, label="link")
    amplitude = ring.START_RAD * np.exp(-ring.D / (2 * ring.M) * run.t)
    for sign in (1, -1):
        label = "predicted: exp(-d t/2M)" if sign == 1 else None
        ax.plot(run.t, 1e3 * sign * amplitude, color=ORANGE, label=label)
    ax.set_title(f"Let go: damping ratio {run.mode.zeta:.4f}, decay {-run.mode.growth:.3f}/s")
    ax.set_ylim(-60, 75)
    name_axes(ax, "time (s)", "angle of the link (mrad)", "upper right")
