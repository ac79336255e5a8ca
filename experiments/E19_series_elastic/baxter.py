"""A whole arm of series elastic joints that is asked for a stiffness at the tip."""

import numpy as np

from limber.experiments.check import Check
from limber.experiments.context import Context
from limber.experiments.probing import Probing
from limber.experiments.truth import joints, motion
from limber.robot import load_robot, read_yaml

ROBOT = "baxter"
K_X = np.diag([300.0] * 3 + [15.0] * 3)  # N/m, N m/rad
PROBING = Probing(first_at=3.0, each_s=2.5, axes=3, force=3.0)
LAWS = {"motor": "law on the motors", "static": "law at the link's rest"}


def springs() -> np.ndarray:
    content = read_yaml(load_robot(ROBOT).folder / "robot.yaml")["joints"].values()
    return np.array([joint["transmission"]["spring"]["stiffness_Nm_per_rad"] for joint in content])


def presented(q: np.ndarray, position: str) -> np.ndarray:
    """K⁻¹ + J K_s⁻¹ Jᵀ of the motors' law; K⁻¹ of the one that counts the springs in."""
    J = load_robot(ROBOT).chain.jacobian(q)
    yields = J @ np.diag(1 / springs()) @ J.T if position == "motor" else np.zeros((6, 6))
    return np.linalg.inv((np.linalg.inv(K_X) + yields)[:3, :3])


def bus(context: Context, position: str) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness formula and stiffness felt, N/m, x to z."""
    gains = {
        "law": "cartesian_impedance",
        "position": position,
        "K_x_translation_N_per_m": float(K_X[0, 0]),
        "K_x_rotation_Nm_per_rad": float(K_X[3, 3]),
        "damping_ratio": 0.7,
    }
    scenario = {
        "robot": ROBOT,
        "friction": False,
        "duration_s": PROBING.end + 0.1,
        "timeline": [
            {"at_s": 0.3, "mode": "hold"},
            {"at_s": 0.8, "mode": "active"},
            {"at_s": 1.0, "gains": gains},
            *PROBING.timeline(),
        ],
    }
    log = context.lab(scenario, f"baxter_{position}")
    q = joints(motion(log, PROBING.first_at - 0.1, PROBING.first_at)).mean(axis=0)
    return presented(q, position), PROBING.stiffness(log)


def checks(context: Context) -> list[Check]:
    made = []
    for position, law in LAWS.items():
        formula, felt = bus(context, position)
        for i, axis in enumerate("xyz"):
            asked, got = (float(1 / np.linalg.inv(K)[i, i]) for K in (formula, felt))
            name = f"Baxter asked for {K_X[0, 0]:g} N/m, {law}, bus: along {axis}"
            made.append(Check(name, asked, got, "N/m", 0.03))
    return made
