"""Where the link will rest is found step by step: how fast, and up to which stiffness."""

from typing import Any

import numpy as np

from limber.errors import RunError
from limber.model.robot import load_robot
from limber_lecture import testbench as bench
from limber_lecture.context import Comparison, Context, case, near_zero
from limber_lecture.variants import variant

from . import joint

TOO_STIFF = 1500.0  # N m/rad


def checks(context: Context) -> list[Comparison]:
    made = []
    for K_d in (*joint.ASKED, TOO_STIFF):
        _, before, after, _ = joint.fixpoint_steps(K_d)
        factor = abs(K_d - joint.gradient()) / joint.SPRING
        name = f"a step of the iteration over the one before, {K_d:g} N m/rad asked for"
        made.append(Comparison(name, factor, after / before, "", 0.01))
    robot = variant(context.out / "solver", bench.ROBOT, bench.gravity(joint.GRAVITY))
    for K_d in joint.ASKED:
        name = f"the controller's own solution, {K_d:g} N m/rad asked for: torque left over"
        made.append(near_zero(name, _left_over(context, robot, K_d), "N m", 1e-8))
    name = f"{TOO_STIFF:g} N m/rad asked for"
    solved, taken = _solvable(context, robot), 1 - joint.refused_bus(context, TOO_STIFF)
    return [
        *made,
        near_zero(f"{name}: solutions, by the controller", solved, "", 0.0),
        near_zero(f"{name}: requests it takes, bus", taken, "", 0.0),
    ]


def _asked(robot: str, K_d: float) -> dict[str, Any]:
    K_x = np.diag([0.0] * 5 + [K_d])
    theta = joint.ANGLE + 0.02 + joint.weight(joint.ANGLE) / joint.SPRING
    goal = load_robot(bench.ROBOT).chain.forward(np.array([joint.ANGLE]))
    pose = {"p_d": goal[:3, 3], "R_d": goal[:3, :3]}
    return case("qbar", robot, theta=[theta], Kx=K_x, K=[joint.SPRING], **pose)


def _left_over(context: Context, robot: str, K_d: float) -> float:
    """K_J (θ - q̄) - l(q̄), with the torque it says and with the one it shall have."""
    question = _asked(robot, K_d)
    (answer,) = context.eval([question])
    q, u = float(answer["qbar"][0]), float(answer["u"][0])
    spring = joint.SPRING * (question["in"]["theta"][0] - q)
    return max(abs(spring - u), abs(u - joint.wanted(q, K_d)))


def _solvable(context: Context, robot: str) -> bool:
    try:
        context.eval([_asked(robot, TOO_STIFF)])
    except RunError as error:
        if "stiffer than the joint springs" not in str(error):
            raise
        return False
    return True
