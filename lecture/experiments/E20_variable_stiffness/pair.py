"""One joint between two tendons: stiffness by pulling both, torque by the difference."""

import numpy as np

from limber_lecture.context import Comparison, Context, case, near_zero
from limber_lecture.search import limit

K_2 = 400.0  # N m/rad²
POINTS = 16


def tension(stretch: np.ndarray) -> np.ndarray:
    """½ k₂ δ², nothing when slack."""
    return 0.5 * K_2 * np.maximum(stretch, 0.0) ** 2


def torque(theta_1: np.ndarray, theta_2: np.ndarray, q: np.ndarray) -> np.ndarray:
    return tension(theta_1 - q) - tension(theta_2 + q)


def inverse_map(context: Context) -> list[Comparison]:
    """Motor angles from the controller's class; torque and its slope from the springs here."""
    sigma = context.rng.uniform(20.0, 200.0, POINTS)
    tau = context.rng.uniform(-0.9, 0.9, POINTS) * sigma**2 / (2 * K_2)
    q = context.rng.uniform(-1.0, 1.0, POINTS)
    (answer,) = context.eval([case("vsa", sigma=sigma, tau=tau, q=q, k2=[K_2] * POINTS)])
    motors = answer["theta1"], answer["theta2"]
    off_torque = np.abs(torque(*motors, q) - tau).max()
    step = 1e-6
    slope = (torque(*motors, q + step) - torque(*motors, q - step)) / (2 * step)
    off_stiffness = np.abs(-slope / sigma - 1).max()
    c, e = (motors[0] + motors[1]) / 2, (motors[0] - motors[1]) / 2
    formula = np.abs(2 * K_2 * c * (e - q) - tau).max()
    name = "motor angles by the controller, 16 points"
    return [
        near_zero(f"{name}: torque of the springs off by", off_torque, "N m", 1e-9),
        near_zero(f"{name}: σ (e - q) off by", formula, "N m", 1e-9),
        near_zero(f"{name}: stiffness off by", off_stiffness, "", 1e-6),
    ]


def least_stiffness(context: Context) -> list[Comparison]:
    """The controller says what is feasible; here: is a tendon slack where the torque is right?"""
    made = []
    for tau in (2.0, 8.0):

        def slack(sigma: float, tau: float = tau) -> bool:
            (answer,) = context.eval([case("vsa", sigma=sigma, tau=tau, q=0.0, k2=K_2)])
            return not answer["feasible"]

        found = limit(slack, 1.0, 1000.0, 1e-4)
        name = f"least stiffness that carries {tau:g} N m"
        made.append(Comparison(name, np.sqrt(2 * K_2 * tau), found, "N m/rad", 1e-3))
    return made


def checks(context: Context) -> list[Comparison]:
    return [*inverse_map(context), *least_stiffness(context)]
