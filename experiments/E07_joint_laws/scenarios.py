"""The runs: let go from beside the target, led around a circle, and pushed at the tip."""

from typing import Any

import numpy as np

from limber.experiments import planar2r as arm
from limber.experiments.probing import Probing

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
    "bias": "gravity",
    "K_q_Nm_per_rad": K_Q.tolist(),
    "joint_damping": "given",
    "D_q_Nms_per_rad": D_Q.tolist(),
}
EQ_8_PRINTED = {**EQ_8, "bias": "none"}
EQ_7 = {
    "law": "eq7",
    "K_x_translation_N_per_m": K_X,
    "stiffness_terms": "first",
    "stiffness_pose": "current",
}
EQ_7_AT_REST = {**EQ_7, "follow_velocity": False}
EQ_9_LITERAL = {**EQ_9, "K_x_translation_N_per_m": K_X, "literal_stiffness": True}


def step(gains: dict[str, Any], torque: np.ndarray) -> dict[str, Any]:
    """Moments hold the joints' torque until the hand lets go at once."""
    held = {"for_s": LET_GO_AT - 1.6}
    link, tip = ({"torque_Nm": [0.0, 0.0, float(m)]} for m in (torque[0] - torque[1], torque[1]))
    pushes = [{**link, **held, "id": 1, "link": "link1"}, {**tip, **held, "id": 2}]
    return _scenario(gains, [{"at_s": 1.6, "push": push} for push in pushes], LET_GO_AT + 3.1)


def circle(gains: dict[str, Any]) -> dict[str, Any]:
    offset = [*(CENTRE - arm.tip(Q_D)).tolist(), 0.0]
    goal = {"circle_centre_m": offset, "circle_axis": [0, 0, 1], "duration_s": PERIOD_S}
    entries = [{"at_s": CIRCLE_AT, "goal": goal}]
    return _scenario(gains, entries, CIRCLE_AT + (TURNS + 1) * PERIOD_S + 0.1)


def contact(gains: dict[str, Any]) -> dict[str, Any]:
    return _scenario(gains, PROBING.timeline(), PROBING.end + 0.1)


def _scenario(
    gains: dict[str, Any], entries: list[dict[str, Any]], duration_s: float
) -> dict[str, Any]:
    return {
        "robot": "planar2r",
        "duration_s": duration_s,
        "integrator": "reference",
        "start_q": Q_D.tolist(),
        "timeline": [
            {"at_s": 0.3, "mode": "hold"},
            {"at_s": 0.8, "mode": "active"},
            {"at_s": 1.0, "gains": gains},
            {"at_s": 1.05, "goal": {"joints_rad": Q_D.tolist(), "duration_s": 0.1}},
            *entries,
        ],
    }
