"""A whole arm of series elastic joints that is asked for a stiffness at the tip."""

from functools import cache

import numpy as np
from scipy.optimize import fsolve
from scipy.spatial.transform import Rotation

from limber.model.robot import Robot, load_robot
from limber_lecture.context import Comparison, Context
from limber_lecture.timeline import in_turn, tip_gains
from limber_lecture.truth import motion, status

ROBOT = "baxter"
K_X = np.diag([300.0] * 3 + [15.0] * 3)  # N/m, N m/rad
K_NULL = 5.0  # N m/rad
PUSH_N = 6.0  # along y, to and fro
PUSH_S, RAMP_S, FIRST_S, EACH_S, REST_S = 2.9, 0.3, 2.0, 3.0, 0.6
LAWS = {"motor": "law on the motors", "static": "law at the link's rest"}


@cache
def arm() -> tuple[Robot, np.ndarray]:
    """The robot and its springs, N m/rad."""
    robot = load_robot(ROBOT)
    springs = [joint["spring_stiffness_Nm_per_rad"] for joint in robot.resolved["joints"]]
    return robot, np.array(springs)


def formula(position: str) -> float:
    """Along y: K⁻¹ + J K_s⁻¹ Jᵀ under a law on the motors, K⁻¹ under one that knows the springs."""
    robot, springs = arm()
    J = robot.chain.jacobian(robot.home)
    yields = J @ np.diag(1 / springs) @ J.T if position == "motor" else np.zeros((6, 6))
    return float(1 / (np.linalg.inv(K_X) + yields)[1, 1])


def ideal(position: str) -> float:
    """From equilibria of all springs, weight and force, at any deflection."""
    return 2 * PUSH_N / (_rest(position, PUSH_N) - _rest(position, -PUSH_N))


def _rest(position: str, force: float) -> float:
    """y of the tip where K_s (θ - q) = l = g(q) - Jᵀ F."""
    robot, springs = arm()
    chain, home, F = robot.chain, robot.home, np.array([0, force, 0, 0, 0, 0])
    goal = chain.forward(home)
    J = chain.jacobian(home)
    null = K_NULL * (np.eye(len(home)) - np.linalg.pinv(J) @ J)

    def weight(q: np.ndarray) -> np.ndarray:
        return robot.dynamics.gravity_torque(q[None])[0]

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
    stiffness = tip_gains(K_X[0, 0], K_X[3, 3], K_null_Nm_per_rad=K_NULL)
    gains = {**stiffness, "position_feedback": position, "damping_ratio": 0.7}
    forces = [{"force_N": [0.0, force, 0.0]} for force in (PUSH_N, -PUSH_N)]
    pushes = in_turn(FIRST_S, EACH_S, forces, ramp_s=RAMP_S, for_s=PUSH_S)
    end, head = FIRST_S + 2 * EACH_S, {"integrator": "ode", "friction": False}
    log = context.run_law(f"baxter_{position}", ROBOT, gains, pushes, end, **head)
    status(log, FIRST_S, end)
    ends = [push["at_s"] + PUSH_S - RAMP_S for push in pushes]
    more, less = (motion(log, t - REST_S, t)["p_BT"][:, 1].mean() for t in ends)
    return float(2 * PUSH_N / (more - less))


def checks(context: Context) -> list[Comparison]:
    made = []
    for position, law in LAWS.items():
        name = f"Baxter asked for {K_X[0, 0]:g} N/m, {law}"
        model, seen = ideal(position), bus(context, position)
        made.append(Comparison(f"{name}, ideal", formula(position), model, "N/m", 0.03))
        made.append(Comparison(f"{name}, bus (prediction: ideal)", model, seen, "N/m", 0.02))
    return made
