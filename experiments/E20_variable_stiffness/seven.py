"""Seven joints with two motors each: how much of a tip stiffness they give; how many motors."""

from pathlib import Path

import numpy as np
from scipy.optimize import nnls

from limber.experiments.check import Check
from limber.experiments.context import Context
from limber.experiments.evaluate import case
from limber.experiments.truth import motion, status
from limber.experiments.variants import variant
from limber.logs import Log
from limber.messages import constants
from limber.robot import load_robot, read_yaml

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


def asked_of_class(context: Context, q: np.ndarray) -> list[Check]:
    ours = fitted(load_robot(ROBOT).chain.jacobian(q))
    (answer,) = context.eval([case("vsa_cartesian", ROBOT, q=q, Kx=K_X)])
    off = np.abs(answer["diag_stiffness"] / ours["diagonal"][0] - 1).max()
    missed = {"diagonal": "residual_stiffness", "compliance": "residual_compliance_weighted"}
    made = [Check("7 joints, diagonal of JᵀKJ: controller off by", 0.0, float(off), "", 1e-9,
                  "absolute")]  # fmt: skip
    for fit in FITS:
        name = f"7 joints, {fit} fit, ideal: share of the wish that is missed"
        made.append(Check(name, float(ours[fit][1]), float(answer[missed[fit]]), "", 1e-6))
    return made


def on_arm(context: Context) -> list[Check]:
    """Without gravity: carrying the arm takes more stiffness than is asked for here."""
    gains = {
        "law": "variable_stiffness",
        "stiffness_fit": "diagonal",
        "K_x_translation_N_per_m": float(K_X[0, 0]),
        "K_x_rotation_Nm_per_rad": float(K_X[3, 3]),
    }
    ends = {"diagonal": 3.0, "compliance": 4.0}
    scenario = {
        "robot": variant(context.out / "seven", ROBOT, {"gravity_m_per_s2": [0.0, 0.0, 0.0]}),
        "duration_s": ends["compliance"] + 0.1,
        "timeline": [
            {"at_s": 0.3, "mode": "hold"},
            {"at_s": 0.8, "mode": "active"},
            {"at_s": 1.0, "gains": gains},
            {"at_s": ends["diagonal"], "gains": {"stiffness_fit": "compliance"}},
        ],
    }
    log = context.lab(scenario, "seven")
    made = []
    for fit, end in ends.items():
        told, rows = status(log, end - 0.2, end), motion(log, end - 0.2, end)
        wanted, missed = fitted(load_robot(ROBOT).chain.jacobian(rows["q"][-1, :7]))[fit]
        name = f"7 joints, {fit} fit, bus: share of the wish that is missed"
        made.append(Check(name, float(missed), float(told["fit_residual"][-1]), "", 0.01))
        if fit == "diagonal":
            off = np.abs(rows["sigma"][:, :7].mean(axis=0) - wanted) / held_by_friction(wanted)
    return [
        *made,
        Check("7 joints, bus: stiffness off, over what friction of the motors holds back", 1.0,
              float(off.max()), "", 0.0, "at_most"),
        Check("motors of 7 joints, bus: by the flags of JOINT_STATE", 14.0, flagged(log), "", 0.0),
        Check("motors of 7 joints, bus: different node ids", 14.0,
              nodes(log.path.parent), "", 0.0),
    ]  # fmt: skip


def held_by_friction(sigma: np.ndarray) -> np.ndarray:
    """2 k₂ δc with δc = 2 F_c/(K_c + σ): servo and springs against both motors' friction."""
    content = read_yaml(load_robot(ROBOT).folder / "robot.yaml")
    held = []
    for joint, stiffness in zip(content["joints"].values(), sigma, strict=True):
        motor = content["motors"][joint["motor"]]
        servo = 2 * motor["rotor_inertia_kgm2"] * motor["gear_ratio"] ** 2 * PRELOAD_SERVO**2
        k_2 = joint["transmission"]["spring"]["k2_Nm_per_rad2"]
        held.append(4 * k_2 * joint["friction"]["coulomb_Nm"] / (servo + stiffness))
    return np.array(held)


def flagged(log: Log) -> float:
    two = next(bit for bit, name in constants("joint_state_t", "JOINT_").items()
               if name == "TWO_MOTORS")  # fmt: skip
    last = log.read("JOINT_STATE")[-1]
    n = last["num_joints"]
    return float(n + np.count_nonzero(last["joint_flags"][:n] & two))


def nodes(run: Path) -> float:
    """Bus and id of every drive in the robot.yaml that the run was made with."""
    joints = read_yaml(run / "robot.yaml")["joints"].values()
    ids = {(joint["bus"], joint["id"]) for joint in joints}
    ids |= {
        (joint["antagonist"].get("bus", joint["bus"]), joint["antagonist"]["id"])
        for joint in joints
    }
    return float(len(ids))
