"""planar2r at its stretched pose: pushed through it, and asked for what is out of reach."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from limber_lecture import planar2r as arm
from limber_lecture.context import Context
from limber_lecture.timeline import UNBOUNDED, tip_gains
from limber_lecture.truth import RAMP, joints, motion, status, time_s

Q_D = np.array([0.2, 0.7])
K = 300.0  # N/m
LAWS = {"cartesian_impedance": "direct law", "opspace_impedance": "law with the tip's inertia"}
LIMITS = RAMP | {"TORQUE", "VELOCITY"}
PUSH_S, LET_GO_S, END_S = 2.0, 4.0, 7.0
PUSH_N = 70.0
REACH = float(arm.LENGTHS.sum())
BEYOND_M = 0.3
MOVE_S, MOVED_S = 2.0, 2.0


@dataclass(frozen=True)
class Track:
    """Truth every millisecond; what the controller says of itself every five."""

    t: np.ndarray
    q: np.ndarray
    v: np.ndarray
    p: np.ndarray
    told: np.ndarray


def run(context: Context, name: str, law: str, end: float, more: list[dict[str, Any]]) -> Track:
    """Limits may act on the law with the inertia only: that is what it is shown for."""
    joints_pd = {"K_q_Nm_per_rad": [200.0, 100.0], "joint_damping_ratio": 1.0}
    gains = tip_gains([K, K, 0.0], law=law, damping_ratio=0.7, **UNBOUNDED, **joints_pd)
    log = context.run_law(name, arm.ROBOT, gains, more, end, start_q=Q_D)
    limits = LIMITS if law == "opspace_impedance" else RAMP
    told = status(log, PUSH_S, end, limits)
    rows = motion(log, PUSH_S, end)
    t = time_s(rows) - PUSH_S
    return Track(t, joints(rows), joints(rows, "v"), rows["p_BT"][:, :2], told)


def pushed_through(context: Context, law: str) -> Track:
    """A hand at the elbow pushes it across the line from base to tip, and lets go."""
    across = arm.across(arm.tip(Q_D)) / np.linalg.norm(arm.tip(Q_D))
    push = {
        "link": "link2",  # its origin is the elbow
        "force_N": [*(PUSH_N * across), 0.0],
        "ramp_s": 0.8,
        "for_s": LET_GO_S - PUSH_S,
    }
    return run(context, f"through_{law}", law, END_S, [{"at_s": PUSH_S, "push": push}])


def out_of_reach(context: Context, law: str) -> Track:
    """The goal moves straight away from the base, to BEYOND_M beyond the stretched arm."""
    away = arm.tip(Q_D) / np.linalg.norm(arm.tip(Q_D))
    offset = (REACH + BEYOND_M) * away - arm.tip(Q_D)
    goal = {"offset_m": [*offset, 0.0], "duration_s": MOVED_S}
    end = MOVE_S + MOVED_S + 4.0
    return run(context, f"beyond_{law}", law, end, [{"at_s": MOVE_S, "goal": goal}])
