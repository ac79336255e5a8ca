"""planar2r moves slowly, is pushed while it does, and says which contact torque it believes in."""

from dataclasses import dataclass

import numpy as np

from limber_lecture import planar2r as arm
from limber_lecture import variants
from limber_lecture.context import Context
from limber_lecture.truth import joints, motion, status, time_s

GAIN = 20.0  # 1/s
STEP_NM = 3.0
VISCOUS = np.array([1.5, 1.0])  # N m s/rad, of the motors
MOVE_S, MOVES_S = 2.0, 6.0
STEP_S = MOVE_S + MOVES_S / 2  # where the motion is fastest and no joint accelerates
PUSH_S = 1.0
START, END = [-0.4, 0.6], [0.8, 1.6]  # rad


@dataclass(frozen=True)
class Seen:
    """Time since the step, s; estimate and truth, N m; joint velocities, rad/s."""

    t: np.ndarray
    estimate: np.ndarray
    truth: np.ndarray
    v: np.ndarray


def seen(context: Context, friction: bool) -> Seen:
    changes = {
        name: {"friction": variants.friction(viscous=d)}
        for name, d in zip(("shoulder", "elbow"), VISCOUS, strict=True)
    }
    robot = variants.variant(context.out, arm.ROBOT, {"joints": changes}) if friction else arm.ROBOT
    gains = {
        "law": "pd_plus",
        "K_q_Nm_per_rad": [200.0, 100.0],
        "joint_damping_ratio": 1.0,
        "contact": "joint_torque",
        "observer_gain_per_s": GAIN,
    }
    push = {"link": "link1", "torque_Nm": [0.0, 0.0, STEP_NM], "for_s": PUSH_S}
    entries = [
        {"at_s": MOVE_S, "goal": {"joints_rad": END, "duration_s": MOVES_S}},
        {"at_s": STEP_S, "push": push},
    ]
    name, end = "viscous" if friction else "free", MOVE_S + MOVES_S
    log = context.run_law(name, robot, gains, entries, end, start_q=START)
    told = status(log, MOVE_S, end)
    rows = motion(log, MOVE_S, end)
    t = time_s(rows)
    first = t[np.flatnonzero(np.abs(rows["tau_external"]).max(axis=1) > 0)[0] - 1]
    at = np.searchsorted(t, time_s(told) - 1e-6)
    return Seen(
        time_s(told) - first,
        joints(told, "tau_ext"),
        joints(rows, "tau_external")[at],
        joints(rows, "v")[at],
    )
