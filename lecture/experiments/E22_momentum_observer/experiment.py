"""Contact torque from motor torques and momentum: how fast it is, and what friction does."""

import numpy as np

from limber_lecture.context import Comparison, Context, near_zero
from limber_lecture.pictures import BLUE, GREEN, MEASURED, Axes, name_axes

from .runs import GAIN, PUSH_S, STEP_NM, VISCOUS, Seen, seen

TITLE = "A contact shows in the momentum after 1/gain; friction shows as if it were contact"
CLAIM = "Joint torques tell the contact torque, without a sensor at the tip"
SECTION = "3"
PLANT = "planar2r in motion, exact equations; without friction, and with viscous motors"
FAST = True


def run(context: Context) -> list[Comparison]:
    free, viscous = seen(context, friction=False), seen(context, friction=True)
    with context.picture(TITLE, columns=2, size=(12.5, 5.0)) as (left, right):
        draw_step(free, left)
        draw_friction(viscous, right)
    late, joints = PUSH_S - 0.05, ("shoulder", "elbow")
    before, after = at(free, 0.0), at(free, late)
    felt = -VISCOUS * viscous.v[np.searchsorted(viscous.t, 0.0) - 1]
    pushed = STEP_NM - VISCOUS[0] * np.interp(late, viscous.t, viscous.v[:, 0])
    in_the_end, name = at(viscous, late)[0], "step of 3 N m, viscous shoulder: in the end"
    return [
        Comparison("63.2 % of a step after", 1 / GAIN, rise_time(free), "s", 0.06),
        Comparison("step of 3 N m, in the end", STEP_NM, after[0] - before[0], "N m", 0.01),
        near_zero("elbow, which is not touched", after[1], "N m", 0.03),
        *(
            Comparison(f"viscous {joint}, no contact: torque seen", torque, seen, "N m", 0.02)
            for joint, torque, seen in zip(joints, felt, at(viscous, 0.0), strict=True)
        ),
        Comparison(name, pushed, in_the_end, "N m", 0.02),
    ]


def at(run: Seen, t: float) -> np.ndarray:
    return np.array([np.interp(t, run.t, estimate) for estimate in run.estimate.T])


def rise_time(run: Seen) -> float:
    """When the estimate has taken 1 - 1/e of the step."""
    during = (run.t >= 0.0) & (run.t < PUSH_S)
    share = (run.estimate[during, 0] - at(run, 0.0)[0]) / STEP_NM
    return float(np.interp(1 - np.exp(-1), share[:60], run.t[during][:60]))


def draw_step(run: Seen, ax: Axes) -> None:
    ms = run.t * 1e3
    ax.plot(ms, run.truth[:, 0], color="0.5", ls="--", label="contact torque")
    rising = np.where(run.t > 0, STEP_NM * (1 - np.exp(-GAIN * np.maximum(run.t, 0))), 0.0)
    ax.plot(ms, rising, color=BLUE, label=f"predicted: 1 - exp(-t/{1e3 / GAIN:.0f} ms)")
    ax.plot(ms[::2], run.estimate[::2, 0], **MEASURED, color=BLUE, label="seen by the observer")
    ax.set_xlim(-60, 360)
    ax.set_title("Shoulder pushed while the arm moves")
    name_axes(ax, "time since the push (ms)", "torque (N m)", "lower right")


def draw_friction(run: Seen, ax: Axes) -> None:
    ax.plot(run.t, run.truth[:, 0], color="0.5", ls="--", label="contact torque")
    friction = run.truth[:, 0] - VISCOUS[0] * run.v[:, 0]
    ax.plot(run.t, friction, color=GREEN, label="contact torque less viscous friction")
    few = slice(None, None, 25)
    ax.plot(run.t[few], run.estimate[few, 0], **MEASURED, color=GREEN, label="seen")
    ax.set_title("Shoulder with a viscous motor")
    name_axes(ax, "time since the push (s)", "torque (N m)", "center left")
