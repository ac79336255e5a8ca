"""What laws do where the tip has lost a direction."""

import numpy as np
from numpy.linalg import norm

from limber_lecture import planar2r as arm
from limber_lecture.context import Comparison, Context, at_most, near_zero
from limber_lecture.pictures import BLUE, ORANGE, Axes, level, name_axes, note
from limber_lecture.truth import time_s

from . import inverse
from .runs import BEYOND_M, LAWS, Q_D, REACH, K, Track, out_of_reach, pushed_through

TITLE = "Through the stretched pose: the direct law does not mind, one with the tip's inertia does"
CLAIM = "A controller in Cartesian space behaves like one in joint space, singular poses included"
SECTION = "3"
PLANT = "planar2r, exact equations; the controller's damped inverse"
FAST = False
TORQUE_LIMIT_NM = 150.0
DIRECT, SHAPING = LAWS


def run(context: Context) -> list[Comparison]:
    found = inverse.norms(context)
    through = {law: pushed_through(context, law) for law in LAWS}
    beyond = {law: out_of_reach(context, law) for law in (DIRECT, "joint_pd")}
    with context.picture(TITLE, columns=3, size=(16.5, 5.0)) as (left, middle, right):
        draw_elbow(through, left)
        draw_torque(through, middle)
        inverse.draw(found, right)
    return [*through_checks(through), *beyond_checks(beyond), *inverse.checks(found)]


def through_checks(through: dict[str, Track]) -> list[Comparison]:
    """The elbow ends on the other side, mirrored; the tip where it was."""
    checks = []
    for law, track in through.items():
        off, name = norm(track.p[-1] - arm.tip(Q_D)), LAWS[law]
        greatest = torque(track).max()
        checks += [
            Comparison(f"{name}, pushed through: elbow", -Q_D[1], track.q[-1, 1], "rad", 0.01),
            near_zero(f"{name}, pushed through: tip off by", off, "m", 1e-3),
            at_most(f"{name}: greatest torque", TORQUE_LIMIT_NM, greatest, "N m", 1e-3),
        ]
    told = through[DIRECT].told
    spring = norm(told["tau_stiffness"], axis=1)
    bound = [
        norm(arm.jacobian(q), 2) * K * norm(e)
        for q, e in zip(told_pose(through[DIRECT]), told["e"][:, :2], strict=True)
    ]
    share = (spring / np.maximum(bound, 1e-3)).max()
    name = "direct law: torque of the spring over ‖J‖ K|e|"
    return [*checks, at_most(name, 1.0, share, margin=1e-2)]


def told_pose(track: Track) -> np.ndarray:
    """Joint angles when the controller spoke."""
    t = time_s(track.told)
    return np.column_stack([np.interp(t - t[0], track.t, q) for q in track.q.T])


def torque(track: Track) -> np.ndarray:
    return np.abs(track.told["tau_sent"]).max(axis=1)


def beyond_checks(beyond: dict[str, Track]) -> list[Comparison]:
    """The nearest point the arm has; the force along the lost direction reaches no joint."""
    away = arm.tip(Q_D) / norm(arm.tip(Q_D))
    direct, through_ik = beyond[DIRECT], beyond["joint_pd"]
    told, name = direct.told[-1], "goal out of reach"
    missed = norm(direct.p[-1] - REACH * away)
    left = norm(through_ik.p[-1] - (REACH + BEYOND_M) * away)
    reached = np.abs(told["tau_stiffness"]).max()
    return [
        near_zero(f"{name}: tip off the nearest point by", missed, "m", 1e-3),
        Comparison(f"{name}: force asked for", K * BEYOND_M, norm(told["F_law"][:2]), "N", 0.01),
        near_zero(f"{name}: torque of that force", reached, "N m", 0.1),
        Comparison(f"{name}, joint law: distance left", BEYOND_M, left, "m", 0.01),
    ]


def draw_elbow(through: dict[str, Track], ax: Axes) -> None:
    for (law, track), color in zip(through.items(), (BLUE, ORANGE), strict=True):
        ax.plot(track.t, np.degrees(track.q[:, 1]), color=color, label=LAWS[law])
    ax.axhline(0, color="0.5", lw=0.8)
    note(ax, "stretched", (4.9, 2), ha="right")
    for angle, text in ((Q_D[1], "start"), (-Q_D[1], "the same tip, the other elbow")):
        level(ax, text, (4.9, np.degrees(angle)), (0, 5), ha="right")
    ax.axvspan(0, 2, color="0.93", zorder=0)
    note(ax, "pushed", (1.0, -92), ha="center")
    ax.set_title("A hand pushes the elbow to the other side")
    name_axes(ax, "time (s)", "angle of the elbow (°)", "best")


def draw_torque(through: dict[str, Track], ax: Axes) -> None:
    for (law, track), color in zip(through.items(), (BLUE, ORANGE), strict=True):
        t = time_s(track.told)
        ax.plot(t - t[0], torque(track), color=color, label=LAWS[law])
    level(ax, "limit of the joints", (4.9, TORQUE_LIMIT_NM), (0, -12), ha="right")
    ax.set_ylim(0, 165)
    ax.set_title("Torque sent meanwhile")
    name_axes(ax, "time (s)", "greatest joint torque (N m)", "center right")
