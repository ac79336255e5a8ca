"""A soft joint that has to follow a path: motor PD alone, and with a flatness feed-forward."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial
from scipy.interpolate import CubicSpline

from limber_lecture import testbench as bench
from limber_lecture.context import Comparison, Context, at_most
from limber_lecture.elastic import State, one_joint, run
from limber_lecture.pictures import BLUE, GREEN, ORANGE, Axes, name_axes
from limber_lecture.testbench import B, M

K_S = 300.0  # N m/rad, the spring of all parts
START_S = 2.0  # of what is done to the joint
ANGLE, MOVE_S, END_S = 0.5, 0.5, 1.2
K_P = 2000.0  # N m/rad, of the motor's servo
K_D = 2 * 0.7 * np.sqrt(K_P * B)
SERIES = K_S * K_P / (K_S + K_P)
# Zero velocity, acceleration, jerk and snap at both ends: four times differentiable
SMOOTH = Polynomial([0, 0, 0, 0, 0, 126, -420, 540, -315, 70])
QUINTIC = Polynomial([0, 0, 0, 10, -15, 6])

Path = Callable[[float, int], float]


@dataclass(frozen=True)
class Followed:
    """`error`: of the link, rad."""

    t: np.ndarray
    error: np.ndarray

    @property
    def worst(self) -> float:
        return float(np.abs(self.error).max())


def along(shape: Polynomial, t: float, order: int = 0) -> float:
    """Derivative of the path at t."""
    inside = min(max(t / MOVE_S, 0.0), 1.0)
    if inside in (0.0, 1.0) and order:
        return 0.0
    return ANGLE * float(shape.deriv(order)(inside) if order else shape(inside)) / MOVE_S**order


def duhamel(shape: Polynomial) -> float:
    """Greatest error where the motor follows as a spring of K_P: M ë + K e = -M q̈_d."""
    omega = np.sqrt(SERIES / M)
    s = np.linspace(0, MOVE_S, 4001)
    a = np.array([along(shape, t, 2) for t in s])
    errors = []
    for t in np.linspace(0, END_S, 601):
        known = s <= t
        kernel = np.sin(omega * (t - s[known])) / omega * a[known]
        errors.append(-np.trapezoid(kernel, s[known]) if known.sum() > 1 else 0.0)
    return float(np.abs(errors).max())


def servo(shape: Polynomial, feed_forward: bool) -> Callable[[float, State], np.ndarray]:
    """Motor PD on θ_d = q_d, or on θ_d = q_d + M q̈_d/K with τ = M q̈_d + B θ̈_d."""

    def law(t: float, x: State) -> np.ndarray:
        q, v, a, jerk, snap = (along(shape, t, order) for order in range(5))
        share = M / K_S if feed_forward else 0.0
        known = M * a + B * (a + share * snap) if feed_forward else 0.0
        return known + K_P * (q + share * a - x.theta) + K_D * (v + share * jerk - x.theta_dot)

    return law


def ideal(shape: Polynomial, feed_forward: bool) -> Followed:
    track = run(one_joint(M, B, K_S, 0.0), servo(shape, feed_forward), END_S)
    wanted = np.array([along(shape, t) for t in track.t])
    return Followed(track.t, track.x.q[:, 0] - wanted)


def bus(context: Context, feed_forward: bool) -> Followed:
    """Errors by the truth: what the link did against the path the controller says."""
    law = "flatness" if feed_forward else "joint_pd"
    gains = bench.given(K_P, float(K_D)) | {"law": law, "position_feedback": "motor"}
    goal = {"at_s": START_S, "goal": {"joints_rad": [ANGLE], "duration_s": MOVE_S}}
    end = START_S + END_S
    log = bench.on_bus(context, law, gains, [goal], end, changes=bench.sprung(K_S, 0.0))
    seen, path = bench.truth(log, START_S, end), CubicSpline(*bench.goal(log, START_S - 0.01, end))
    return Followed(seen["t"] - START_S, seen["q"] - path(seen["t"]))


def found(context: Context) -> dict[str, Followed]:
    return {
        "motor PD, ideal": ideal(QUINTIC, False),
        "flatness, ideal": ideal(SMOOTH, True),
        "motor PD, bus": bus(context, False),
        "flatness, bus": bus(context, True),
    }


def checks(runs: dict[str, Followed]) -> list[Comparison]:
    name = "0.5 rad in 0.5 s with the motor on the path: greatest error of the link"
    worst = {key: run.worst * 1e3 for key, run in runs.items()}
    model, seen = worst["motor PD, ideal"], worst["motor PD, bus"]
    made = [
        Comparison(f"{name}, ideal", duhamel(QUINTIC) * 1e3, model, "mrad", 0.05),
        Comparison(f"{name}, bus", model, seen, "mrad", 0.02),
    ]
    name = "0.5 rad in 0.5 s with flatness: greatest error of the link"
    for where in ("ideal", "bus"):
        made.append(at_most(f"{name}, {where}", 1.0, worst[f"flatness, {where}"], "mrad"))
    return made


def draw(runs: dict[str, Followed], ax: Axes) -> None:
    for name, color, dashes, word in (
        ("motor PD", ORANGE, "0.3", "motor on the path"),
        ("flatness", GREEN, BLUE, "flatness"),
    ):
        one, other = runs[f"{name}, ideal"], runs[f"{name}, bus"]
        ax.plot(one.t, one.error * 1e3, color=color, label=f"{word}, ideal")
        ax.plot(other.t, other.error * 1e3, "--", color=dashes, label=f"{word}, bus")
    ax.set_title("0.5 rad in 0.5 s through a spring of 300 N m/rad")
    name_axes(ax, "time (s)", "error of the link (mrad)", "lower right")
