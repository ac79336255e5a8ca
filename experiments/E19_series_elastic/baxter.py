"""A whole arm of series elastic joints that is asked for a stiffness at the tip."""

from functools import cache

import numpy as np
from scipy.optimize import fsolve
from scipy.spatial.transform import Rotation

from limber.dynamics import ArmDynamics
from limber.experiments.check import Check
from limber.experiments.context import Context
from limber.experiments.truth import motion, status
from limber.robot import Robot, load_robot, read_yaml

ROBOT = "baxter"
K_X = np.diag([300.0] * 3 + [15.0] * 3)  # N/m, N m/rad
K_NULL = 5.0  # N m/rad
PUSH_N = 6.0  # along y, to and fro
PUSH_S, FIRST_S, EACH_S, REST_S = 2.9, 2.0, 3.0, 0.6
LAWS = {"motor": "law on the motors", "static": "law at the link's rest"}


@cache
def arm() -> tuple[Robot, ArmDynamics, np.ndarray, np.ndarray]:
    """Kinematics, weight, springs (N m/rad) and home."""
    robot = load_robot(ROBOT)
    joints = read_yaml(robot.folder / "robot.yaml")["joints"].values()
    springs = [joint["transmission"]["spring"]["stiffness_Nm_per_rad"] for joint in joints]
    home = np.array([joint["home_rad"] for joint in joints], float)
    return robot, ArmDynamics(robot.urdf, robot.chain, robot.gravity), np.array(springs), home


def formula(position: str) -> float:
    """Along y: K⁻¹ + J K_s⁻¹ Jᵀ under a law on the motors, K⁻¹ under one that knows the springs."""
    robot, _, springs, home = arm()
    J = robot.chain.jacobian(home)
    yields = J @ np.diag(1 / springs) @ J.T if position == "motor" else np.zeros((6, 6))
    return float(1 / (np.linalg.inv(K_X) + yields)[1, 1])


def ideal(position: str) -> float:
    """From equilibria of all springs, weight and force, at any deflection."""
    return 2 * PUSH_N / (_rest(position, PUSH_N) - _rest(position, -PUSH_N))


def _rest(position: str, force: float) -> float:
    """y of the tip where K_s (θ - q) = l = g(q) - Jᵀ F."""
    robot, dynamics, springs, home = arm()
    chain, goal, F = robot.chain, robot.chain.forward(home), np.array([0, force, 0, 0, 0, 0])
    J = chain.jacobian(home)
    null = K_NULL * (np.eye(len(home)) - np.linalg.pinv(J) @ J)

    def weight(q: np.ndarray) -> np.ndarray:
        return dynamics.gravity_torque(q[None])[0]

    def left(x: np.ndarray) -> np.ndarray:
        q, theta = x.reshape(2, -1)
        tau = springs * (theta - q)
        seen = theta if position == "motor" else q  # q̄ is the link where the torque is as asked
        there = chain.forward(seen)
        turned = Rotation.from_matrix(there[:3, :3] @ goal[:3, :3].T).as_rotvec()
        e = np.concatenate([there[:3, 3] - goal[:3, 3], turned])
        law = weight(seen) - chain.jacobian(seen).T @ K_X @ e - null @ (seen - home)
        return np.concatenate([tau + chain.jacobian(q).T @ F - weight(q), tau - law])

    q = fsolve(left, np.concatenate([home, home + weight(home) / springs]), xtol=1e-10)[: len(home)]
    return float(chain.forward(q)[1, 3])


def bus(context: Context, position: str) -> float:
    gains = {
        "law": "cartesian_impedance",
        "position": position,
        "K_x_translation_N_per_m": float(K_X[0, 0]),
        "K_x_rotation_Nm_per_rad": float(K_X[3, 3]),
        "K_null_Nm_per_rad": K_NULL,
        "damping_ratio": 0.7,
    }
    shape = {"ramp_s": 0.3, "for_s": PUSH_S}
    pushes = [
        {"at_s": FIRST_S + i * EACH_S, "push": {"force_N": [0.0, sign * PUSH_N, 0.0], **shape}}
        for i, sign in enumerate((1, -1))
    ]
    end = FIRST_S + 2 * EACH_S
    scenario = {
        "robot": ROBOT,
        "friction": False,
        "duration_s": end + 0.1,
        "timeline": [
            {"at_s": 0.3, "mode": "hold"},
            {"at_s": 0.8, "mode": "active"},
            {"at_s": 1.0, "gains": gains},
            *pushes,
        ],
    }
    log = context.lab(scenario, f"baxter_{position}")
    status(log, FIRST_S, end)
    ends = [FIRST_S + i * EACH_S + PUSH_S - shape["ramp_s"] for i in range(2)]
    more, less = (motion(log, t - REST_S, t)["p_BT"][:, 1].mean() for t in ends)
    return float(2 * PUSH_N / (more - less))


def checks(context: Context) -> list[Check]:
    made = []
    for position, law in LAWS.items():
        name = f"Baxter asked for {K_X[0, 0]:g} N/m, {law}"
        model = ideal(position)
        made.append(Check(f"{name}, ideal", formula(position), model, "N/m", 0.03))
        made.append(
            Check(f"{name}, bus (prediction: ideal)", model, bus(context, position), "N/m", 0.02)
        )
    return made
