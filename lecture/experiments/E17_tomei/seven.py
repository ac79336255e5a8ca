"""The condition of the proof on a seven-joint arm."""

import numpy as np

from limber_lecture.context import Comparison, Context, at_least, case
from limber_lecture.inertia import gravity_gradient

ROBOT = "ideal7"
SPRING = 1e3 * np.array([8.0, 8.0, 6.0, 6.0, 3.0, 3.0, 2.0])  # N m/rad
SHARE = 3.0  # K_P over the steepest gravity
POSES = 16


def steepest_gravity(context: Context) -> float:
    """α: greatest ‖∂g/∂q‖ at random poses, N m/rad."""
    poses = context.rng.uniform(-np.pi, np.pi, (POSES, 7))
    return max(float(np.linalg.norm(gravity_gradient(ROBOT, q), 2)) for q in poses)


def checks(context: Context) -> list[Comparison]:
    alpha = steepest_gravity(context)
    K_P = SHARE * alpha * np.ones(7)
    zero = np.zeros(7)
    gains = {"K": SPRING, "KP": K_P, "KD": K_P / 10}
    (answer,) = context.eval([case("tomei", ROBOT, theta=zero, thetad=zero, q_d=zero, **gains)])
    K = np.diag(SPRING)
    blocks = np.block([[K, -K], [-K, K + np.diag(K_P)]])
    smallest = float(np.linalg.eigvalsh(blocks)[0])
    found = float(answer["lambda_min"])
    name = f"seven joints, K_P of {SHARE:g} α: smallest eigenvalue"
    return [
        Comparison(f"{name}, by the controller", smallest, found, "N m/rad", 1e-6),
        at_least(f"{name}, above α", alpha, found, "N m/rad"),
    ]
