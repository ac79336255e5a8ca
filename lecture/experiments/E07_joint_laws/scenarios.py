"""The runs: let go from beside the target, led around a circle, and pushed at the tip."""

from typing import Any

import numpy as np

from limber_lecture import planar2r as arm
from limber_lecture.context import Context
from limber_lecture.probing import Probing
from limber_lecture.timeline import in_turn, joint_damping
from limber_lecture.truth import Log

Q_D = np.array([0.5, 1.0])
K_ACC, ZETA = 100.0, 0.5  # 1/s², of each joint
M = arm.inertia(Q_D)
# Eq. 8 with the gains that suit the inertia each joint has at the target
K_Q, D_Q = K_ACC * np.diag(M), 2 * ZETA * np.sqrt(K_ACC) * np.diag(M)
STEP = 0.3  # rad
LET_GO_AT = 6.0
CIRCLE_AT, TURNS, RADIUS, PERIOD_S = 1.5, 6, 0.1, 1.0
CENTRE = arm.tip(Q_D) * (1 - RADIUS / np.linalg.norm(arm.tip(Q_D)))  # on the way to the base
PROBING = Probing(first_at=2.0, each_s=6.0, axes=2, force=0.2)
K_X = 500.0  # N/m

EQ_9 = {"law": "computed_torque", "K_acc_per_s2": K_ACC, "joint_damping_ratio": ZETA}
EQ_8 = {
    "law": "joint_pd",
    "model_compensation": "gravity",
    "K_q_Nm_per_rad": K_Q,
    **joint_damping(D_Q),
}
EQ_8_PRINTED = {**EQ_8, "model_compensation": "none"}
EQ_7 = {
    "law": "mapped_joint_impedance",
    "K_x_translation_N_per_m": K_X,
    "stiffness_terms": "first",
    "stiffness_pose": "current",
}
EQ_7_AT_REST = {**EQ_7, "follow_velocity": False}
EQ_9_LITERAL = {**EQ_9, "K_x_translation_N_per_m": K_X, "literal_stiffness": True}


def step(context: Context, name: str, gains: dict[str, Any], torque: np.ndarray) -> Log:
    """Moments hold the joints' torque until the hand lets go at once."""
    link, tip = ({"torque_Nm": [0.0, 0.0, m]} for m in (torque[0] - torque[1], torque[1]))
    pushes = [{**link, "id": 1, "link": "link1"}, {**tip, "id": 2}]
    entries = in_turn(1.6, 0.0, pushes, for_s=LET_GO_AT - 1.6)
    return _run(context, name, gains, entries, LET_GO_AT + 3.0)


def circle(context: Context, name: str, gains: dict[str, Any]) -> Log:
    offset = [*(CENTRE - arm.tip(Q_D)), 0.0]
    goal = {"circle_centre_m": offset, "circle_axis": [0, 0, 1], "duration_s": PERIOD_S}
    entries = [{"at_s": CIRCLE_AT, "goal": goal}]
    return _run(context, name, gains, entries, CIRCLE_AT + (TURNS + 1) * PERIOD_S)


def contact(context: Context, name: str, gains: dict[str, Any]) -> Log:
    return _run(context, name, gains, PROBING.timeline(), PROBING.end)


def _run(context: Context, name: str, gains: dict[str, Any], entries: list, end_s: float) -> Log:
    start = {"at_s": 1.05, "goal": {"joints_rad": Q_D, "duration_s": 0.1}}
    return context.run_law(name, arm.ROBOT, gains, [start, *entries], end_s, start_q=Q_D)
