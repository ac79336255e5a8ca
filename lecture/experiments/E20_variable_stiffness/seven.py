"""Seven joints with two motors each: how much of a tip stiffness they give; how many motors."""

from pathlib import Path

import numpy as np
from scipy.optimize import nnls

from limber.messages import message_class
from limber.model.robot import load_robot
from limber.yaml_file import read_yaml
from limber_lecture.context import Comparison, Context, at_most, case, near_zero
from limber_lecture.timeline import tip_gains
from limber_lecture.truth import Log, motion, status
from limber_lecture.variants import variant

ROBOT = "antagonist7"
K_X = np.diag([100.0] * 3 + [3.0] * 3)  # N/m, N m/rad
PRELOAD_SERVO = 30.0  # rad/s, of the controller
FITS = ("diagonal", "compliance")


def fitted(J: np.ndarray) -> dict[str, tuple[np.ndarray, float]]:
    """Joint stiffness or compliance, and the share missed, for each way of fitting."""
    K_q = J.T @ K_X @ J
    diagonal = np.diag(np.diag(K_q))
    W, C = np.sqrt(np.diag(K_X)), np.linalg.inv(K_X)
    weigh = np.outer(W, W)
    columns = np.column_stack([(weigh * np.outer(j, j)).ravel() for j in J.T])
    s, left = nnls(columns, (weigh * C).ravel())
    return {
        "diagonal": (np.diag(K_q), np.linalg.norm(K_q - diagonal) / np.linalg.norm(K_q)),
        "compliance": (s, left / np.linalg.norm(weigh * C)),
    }


def asked_of_class(context: Context, q: np.ndarray) -> list[Comparison]:
    ours = fitted(load_robot(ROBOT).chain.jacobian(q))
    (answer,) = context.eval([case("vsa_cartesian", ROBOT, q=q, Kx=K_X)])
    off = np.abs(answer["diag_stiffness"] / ours["diagonal"][0] - 1).max()
    missed = {"diagonal": "residual_stiffness", "compliance": "residual_compliance_weighted"}
    made = [near_zero("7 joints, diagonal of JᵀKJ: controller off by", off, "", 1e-9)]
    for fit in FITS:
        name = f"7 joints, {fit} fit, ideal: share of the wish that is missed"
        made.append(Comparison(name, ours[fit][1], answer[missed[fit]], "", 1e-6))
    return made


def on_arm(context: Context) -> list[Comparison]:
    """Without gravity: carrying the arm takes more stiffness than is asked for here."""
    law = {"law": "variable_stiffness", "stiffness_fit": "diagonal"}
    gains = tip_gains(K_X[0, 0], K_X[3, 3], **law)
    ends = {"diagonal": 3.0, "compliance": 4.0}
    robot = variant(context.out / "seven", ROBOT, {"gravity_m_per_s2": [0.0, 0.0, 0.0]})
    other = {"at_s": ends["diagonal"], "gains": {"stiffness_fit": "compliance"}}
    log = context.run_law("seven", robot, gains, [other], ends["compliance"], integrator="ode")
    made = []
    for fit, end in ends.items():
        # law_outputs of variable_stiffness: sigma of the seven joints, then fit_residual
        told, rows = status(log, end - 0.2, end), motion(log, end - 0.2, end)
        wanted, missed = fitted(load_robot(ROBOT).chain.jacobian(rows["q"][-1, :7]))[fit]
        name = f"7 joints, {fit} fit, bus: share of the wish that is missed"
        made.append(Comparison(name, missed, told["law_outputs"][-1, 7], "", 0.01))
        if fit == "diagonal":
            off = np.abs(rows["sigma"][:, :7].mean(axis=0) - wanted) / held_by_friction(wanted)
    name = "7 joints, bus: stiffness off, over what friction of the motors holds back"
    motors = "motors of 7 joints, bus"
    return [
        *made,
        at_most(name, 1.0, off.max()),
        Comparison(f"{motors}: by the flags of JOINT_STATE", 14.0, flagged(log), "", 0.0),
        Comparison(f"{motors}: different node ids", 14.0, nodes(log.path.parent), "", 0.0),
    ]


def held_by_friction(sigma: np.ndarray) -> np.ndarray:
    """2 k₂ δc with δc = 2 F_c/(K_c + σ): servo and springs against both motors' friction."""
    held = []
    for joint, stiffness in zip(load_robot(ROBOT).resolved["joints"], sigma, strict=True):
        servo = 2 * joint["rotor_inertia_kgm2"] * PRELOAD_SERVO**2
        k_2 = joint["spring_k2_Nm_per_rad2"]
        held.append(4 * k_2 * joint["friction"]["coulomb_Nm"] / (servo + stiffness))
    return np.array(held)


def flagged(log: Log) -> float:
    two = message_class("joint_state_t").JOINT_TWO_MOTORS
    last = log.read("JOINT_STATE")[-1]
    n = last["num_joints"]
    return float(n + np.count_nonzero(last["joint_flags"][:n] & two))


def nodes(run: Path) -> float:
    """Bus and id of every drive in the robot.yaml that the run was made with."""
    joints = read_yaml(run / "robot.yaml")["joints"].values()
    ids = {(joint["bus"], joint["id"]) for joint in joints}
    others = [(joint["bus"], joint["antagonist"]) for joint in joints]
    ids |= {(other.get("bus", bus), other["id"]) for bus, other in others}
    return float(len(ids))
