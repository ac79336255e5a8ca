"""Joint impedance on planar2r that knows its contacts from the tip's sensor, or from the joints."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from limber_lecture import planar2r as arm
from limber_lecture.context import Context
from limber_lecture.timeline import in_turn
from limber_lecture.truth import joints, motion, status
from limber_lecture.variants import TIP_SENSOR, variant

SOURCES = {"joint_torque": "joint torques", "tip_sensor": "tip sensor"}
Q_D = np.array([0.5, 1.0])
M_D = np.array([0.8, 0.3])  # kg m², wanted: lighter than the arm, and not coupled
K_D = np.array([40.0, 25.0])  # N m/rad
START_S, PUSH_S = 2.0, 2.5
TORQUE = np.array([4.0, 0.0])  # N m about the first joint, on link 1
FORCE = np.array([-5.0, 8.0])  # N at the tip
PUSHES: dict[str, dict[str, Any]] = {
    "link 1": {"link": "link1", "torque_Nm": [0.0, 0.0, float(TORQUE[0])]},
    "the tip": {"force_N": [*FORCE.tolist(), 0.0]},
}


@dataclass(frozen=True)
class Rest:
    """How far the joints have given way at rest, rad: pushed `where`, contact known by `source`."""

    where: str
    source: str
    moved: np.ndarray


def runs(context: Context) -> list[Rest]:
    robot = variant(context.out, arm.ROBOT, {"tip_sensor": {**TIP_SENSOR, "bus": "arm"}})
    return [rest for source in SOURCES for rest in pushed(context, robot, source)]


def pushed(context: Context, robot: str, source: str) -> list[Rest]:
    gains = {
        "law": "joint_impedance",
        "contact": source,
        "M_q_kgm2": M_D,
        "K_q_Nm_per_rad": K_D,
        "joint_damping_ratio": 1.0,
    }
    pushes = in_turn(START_S, 2 * PUSH_S, PUSHES.values(), ramp_s=0.5, for_s=PUSH_S)
    end = START_S + len(pushes) * 2 * PUSH_S
    log = context.run_law(source, robot, gains, pushes, end, start_q=Q_D)
    status(log, START_S, end)
    found = []
    for where, push in zip(PUSHES, pushes, strict=True):
        released = push["at_s"] + PUSH_S - 0.5
        before = joints(motion(log, push["at_s"] - 0.1, push["at_s"]))[-1]
        at_rest = joints(motion(log, released - 0.1, released))[-1]
        found.append(Rest(where, source, at_rest - before))
    return found


def predicted(where: str, source: str) -> np.ndarray:
    """K_d q̃ = τ where the contact is seen; M M_d⁻¹ K_d q̃ = τ where it is not."""
    seen = where == "the tip" or source == "joint_torque"
    moved = np.zeros(2)
    for _ in range(50):  # τ and M belong to the pose it comes to rest in
        q = Q_D + moved
        tau = TORQUE if where == "link 1" else arm.jacobian(q).T @ FORCE
        moved = tau / K_D if seen else M_D / K_D * np.linalg.solve(arm.inertia(q), tau)
    return moved
