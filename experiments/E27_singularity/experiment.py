"""What laws do where the tip has lost a direction."""

from typing import Any

import numpy as np

from limber.experiments import planar2r as arm
from limber.experiments.check import Check
from limber.experiments.context import Context
from limber.experiments.pictures import BLUE, ORANGE

from . import inverse
from .runs import BEYOND_M, LAWS, Q_D, REACH, K, Track, out_of_reach, pushed_through

TITLE = "Through the stretched pose: the direct law does not mind, one with the tip's inertia does"
CLAIM = "A controller in Cartesian space behaves like one in joint space, singular poses included"
SECTION = "3"
PLANT = "planar2r, exact equations; the controller's damped inverse"
FAST = False
TORQUE_LIMIT_NM = 150.0
DIRECT, SHAPING = LAWS


def run(context: Context) -> list[Check]:
    found = inverse.norms(context)
    through = {law: pushed_through(context, law) for law in LAWS}
    beyond = {law: out_of_reach(context, law) for law in (DIRECT, "joint_pd")}
    with context.picture(TITLE, columns=3, size=(16.5, 5.0)) as (left, middle, right):
        draw_elbow(through, left)
        draw_torque(through, middle)
        inverse.draw(found, right)
    return [*through_checks(through), *beyond_checks(beyond), *inverse.checks(found)]


def through_checks(through: dict[str, Track]) -> list[Check]:
    """The elbow ends on the other side, mirrored; the tip where it was."""
    checks = []
    for law, track in through.items():
        off = float(np.linalg.norm(track.p[-1] - arm.tip(Q_D)))
        name = LAWS[law]
        checks.append(Check(f"{name}, pushed through: elbow", -Q_D[1], track.q[-1, 1], "rad", 0.01))
        checks.append(Check(f"{name}, pushed through: tip off by", 0.0, off, "m", 1e-3, "absolute"))
        checks.append(
            Check(
                f"{name}: greatest torque",
                TORQUE_LIMIT_NM,
                torque(track).max(),
                "N m",
                1e-3,
                "at_most",
            )
        )
    told = through[DIRECT].told
    spring = np.linalg.norm(told["tau_stiffness"], axis=1)
    bound = [
        np.linalg.norm(arm.jacobian(q), 2) * K * np.linalg.norm(e)
        for q, e in zip(told_pose(through[DIRECT]), told["e"][:, :2], strict=True)
    ]
    share = float((spring / np.maximum(bound, 1e-3)).max())
    return [
        *checks,
        Check("direct law: torque of the spring over ‖J‖ K|e|", 1.0, share, "", 1e-2, "at_most"),
    ]


def told_pose(track: Track) -> np.ndarray:
    """Joint angles when the controller spoke."""
    t = track.told["time_ns"] * 1e-9
    return np.column_stack([np.interp(t - t[0], track.t, q) for q in track.q.T])


def torque(track: Track) -> np.ndarray:
    return np.abs(track.told["tau_sent"]).max(axis=1)


def beyond_checks(beyond: dict[str, Track]) -> list[Check]:
    """The nearest point the arm has; the force along the lost direction reaches no joint."""
    away = arm.tip(Q_D) / np.linalg.norm(arm.tip(Q_D))
    direct, through_ik = beyond[DIRECT], beyond["joint_pd"]
    told = direct.told[-1]
    missed = float(np.linalg.norm(direct.p[-1] - REACH * away))
    left = float(np.linalg.norm(through_ik.p[-1] - (REACH + BEYOND_M) * away))
    force = float(np.linalg.norm(told["F_law"][:2]))
    reached = float(np.abs(told["tau_stiffness"]).max())
    return [
        Check(
            "goal out of reach: tip off the nearest point by", 0.0, missed, "m", 1e-3, "absolute"
        ),
        Check("goal out of reach: force asked for", K * BEYOND_M, force, "N", 0.01),
        Check("goal out of reach: torque of that force", 0.0, reached, "N m", 0.1, "absolute"),
        Check("goal out of reach, joint law: distance left", BEYOND_M, left, "m", 0.01),
    ]


def draw_elbow(through: dict[str, Track], ax: Any) -> None:
    for (law, track), color in zip(through.items(), (BLUE, ORANGE), strict=True):
        ax.plot(track.t, np.degrees(track.q[:, 1]), color=color, label=LAWS[law])
    ax.axhline(0, color="0.5", lw=0.8)
    ax.annotate("stretched", (4.9, 2), ha="right", color="0.35")
    for angle, text in ((Q_D[1], "start"), (-Q_D[1], "the same tip, the other elbow")):
        ax.axhline(np.degrees(angle), color="0.5", ls=":", lw=1)
        ax.annotate(text, (4.9, np.degrees(angle) + 2), ha="right", color="0.35")
    ax.axvspan(0, 2, color="0.93", zorder=0)
    ax.annotate("pushed", (1.0, -92), ha="center", color="0.35")
    ax.set_title("A hand pushes the elbow to the other side")
    ax.set_xlabel("time (s)")
    ax.set_ylabel("angle of the elbow (°)")
    ax.legend()


def draw_torque(through: dict[str, Track], ax: Any) -> None:
    for (law, track), color in zip(through.items(), (BLUE, ORANGE), strict=True):
        t = (track.told["time_ns"] - track.told["time_ns"][0]) * 1e-9
        ax.plot(t, torque(track), color=color, label=LAWS[law])
    ax.axhline(TORQUE_LIMIT_NM, color="0.5", ls=":", lw=1)
    ax.annotate("limit of the joints", (4.9, 143), ha="right", color="0.35")
    ax.set_ylim(0, 165)
    ax.set_title("Torque sent meanwhile")
    ax.set_xlabel("time (s)")
    ax.set_ylabel("greatest joint torque (N m)")
    ax.legend(loc="center right")
