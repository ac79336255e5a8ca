"""The condition of the proof on a seven-joint arm."""

import numpy as np

from limber.experiments.check import Check
from limber.experiments.context import Context
from limber.experiments.evaluate import case
from limber.experiments.inertia import gravity_gradient

ROBOT = "ideal7"
SPRING = 1e3 * np.array([8.0, 8.0, 6.0, 6.0, 3.0, 3.0, 2.0])  # N m/rad
SHARE = 3.0  # K_P over the steepest gravity
POSES = 16


def steepest_gravity(context: Context) -> float:
    """α: greatest ‖∂g/∂q‖ at random poses, N m/rad."""
    poses = context.rng.uniform(-np.pi, np.pi, (POSES, 7))
    return max(float(np.linalg.norm(gravity_gradient(ROBOT, q), 2)) for q in poses)


def checks(context: Context) -> list[Check]:
    alpha = steepest_gravity(context)
    K_P = SHARE * alpha * np.ones(7)
    zero = np.zeros(7)
    gains = {"K": SPRING, "KP": K_P, "KD": K_P / 10}
    (answer,) = context.eval([case("tomei", ROBOT, theta=zero, thetad=zero, q_d=zero, **gains)])
    blocks = np.block(
        [[np.diag(SPRING), -np.diag(SPRING)], [-np.diag(SPRING), np.diag(SPRING + K_P)]]
    )
    smallest = float(np.linalg.eigvalsh(blocks)[0])
    found = float(answer["lambda_min"])
    name = f"seven joints, K_P of {SHARE:g} α: smallest eigenvalue"
    return [
        Check(f"{name}, by the controller", smallest, found, "N m/rad", 1e-6),
        Check(f"{name}, above α", alpha, found, "N m/rad", 0.0, "at_least"),
    ]
