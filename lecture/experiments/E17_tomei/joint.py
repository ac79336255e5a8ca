"""An arm held upright through a soft spring, by a law that sees the motor only.

τ_m = g(q_d) - K_P (θ - θ_d) - K_D θ̇,  θ_d = q_d + g(q_d)/K_J (Tomei 1991).
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from limber.model.scenario import GAINS_S
from limber_lecture import testbench as bench
from limber_lecture.context import Context
from limber_lecture.plants import growth
from limber_lecture.search import limit

SPRING, GRAVITY = 60.0, 20.0  # N m/rad of the joint; N m that the link weighs when it lies
K_D = 6.0  # N m s/rad
UPRIGHT = np.pi
CRITICAL = GRAVITY * SPRING / (SPRING - GRAVITY)
SUFFICIENT = SPRING**2 / (SPRING - GRAVITY) - SPRING + GRAVITY
FINE_S = 1e-4


def series(K_P: float, spring: float = SPRING) -> float:
    return 1 / (1 / K_P + 1 / spring)


def final_error(K_P: float, spring: float = SPRING) -> float:
    """From upright: where the spring's pull is the weight's, k e = α sin e."""
    k = series(K_P, spring)
    if k >= GRAVITY:
        return 0.0
    return float(brentq(lambda e: k * e - GRAVITY * np.sin(e), 1e-6, np.pi))


def final_error_model(K_P: float, start: float, seconds: float, spring: float = SPRING) -> float:
    """Let go beside upright, until it rests."""
    A, inputs = bench.elastic(spring)

    def rate(_: float, x: np.ndarray) -> np.ndarray:
        u = -K_P * (x[2] - UPRIGHT) - K_D * x[3]
        return A @ x + inputs @ [u, -bench.weight(x[0], GRAVITY)]

    first = [UPRIGHT - start, 0.0, UPRIGHT - start, 0.0]
    found = solve_ivp(rate, (0.0, seconds), first, method="LSODA", rtol=1e-8, atol=1e-10)
    return abs(float(found.y[0, -1]) - UPRIGHT)


def path_model(K_P: float, t: np.ndarray, q_d: np.ndarray) -> np.ndarray:
    """Angles of the link while the goal goes up; at rest at first."""
    A, inputs = bench.elastic(SPRING)

    def rate(now: float, x: np.ndarray) -> np.ndarray:
        goal = np.interp(now, t, q_d)
        carried = bench.weight(goal, GRAVITY)
        u = carried - K_P * (x[2] - goal - carried / SPRING) - K_D * x[3]
        return A @ x + inputs @ [u, -bench.weight(x[0], GRAVITY)]

    first = [q_d[0], 0.0, q_d[0] + bench.weight(q_d[0], GRAVITY) / SPRING, 0.0]
    span = (t[0], t[-1])
    tight = {"method": "LSODA", "rtol": 1e-7, "atol": 1e-9, "max_step": 0.02}
    return solve_ivp(rate, span, first, t_eval=t, **tight).y[0]


def critical_model() -> float:
    """Found by trying: the smallest K_P that keeps the link up, close to upright."""
    A, inputs = bench.elastic(SPRING)
    A = A.copy()
    A[1, 0] += GRAVITY / bench.M

    def falls(K_P: float) -> bool:
        return growth(bench.looped((A, inputs), [0.0, 0.0, K_P, K_D], FINE_S, 0)) > 1.0

    return limit(falls, 1.0, 1e3)


def changes(spring: float, gravity: float) -> dict:
    """Of the bench. A law that holds it meanwhile must be softer than the spring."""
    softer = {"K_q_Nm_per_rad": 0.6 * spring, "K_x_translation_N_per_m": 40.0}
    return {**bench.gravity(gravity), **bench.sprung(spring), "gains": softer}


# The controller refuses gains below the bound of the proof. Here it takes the link for lighter than
# it is, and so accepts them; upright the weight it believes in does not matter, g(q_d) = 0.
BELIEVED = 5.0
PLANT_OVERRIDES = bench.gravity(GRAVITY)
# Fine steps of the torque, where little torque decides
FINE_MOTOR = bench.motor(rated_torque_Nm=1.0, peak_torque_Nm=32.0)


def gains(K_P: float) -> dict:
    return {"law": "tomei", **bench.given(K_P, K_D)}


def final_error_bus(
    context: Context, K_P: float, start: float, seconds: float, spring: float = SPRING
) -> float:
    """From a goal beside upright, which then goes there."""
    goal = {"at_s": GAINS_S + 0.6, "goal": {"joints_rad": [UPRIGHT], "duration_s": 0.5}}
    end, name = GAINS_S + seconds, f"upright_{spring:g}_{K_P:g}"
    real = {"changes": changes(spring, BELIEVED), "plant_overrides": PLANT_OVERRIDES}
    log = bench.on_bus(context, name, gains(K_P), [goal], end, **real, start_q=[UPRIGHT - start])
    return abs(bench.mean(log, end - 0.5, end) - UPRIGHT)


@dataclass(frozen=True)
class Path:
    """Time since the goal left, s; goal and link, rad."""

    t: np.ndarray
    q_d: np.ndarray
    q: np.ndarray


def from_afar_bus(context: Context, K_P: float, start: float) -> Path:
    """The goal jumps up as fast as goals may."""
    end, name = 8.0, f"from_afar_{K_P:g}"
    goal = {"at_s": 2.0, "goal": {"joints_rad": [UPRIGHT], "duration_s": 0.1}}
    robot = {"changes": changes(SPRING, GRAVITY), "start_q": [UPRIGHT - start]}
    log = bench.on_bus(context, name, gains(K_P), [goal], end, **robot)
    seen = bench.truth(log, 1.95, end)
    t, q_d = bench.goal(log, 1.95, end)
    return Path(t - 2.0, q_d, np.interp(t, seen["t"], seen["q"]))


def critical_bus(context: Context, tried: list[float]) -> float:
    """Where a small push neither grows nor dies out, between two gains that were tried."""
    robot = {
        "changes": {**changes(SPRING, BELIEVED), **FINE_MOTOR},
        "plant_overrides": PLANT_OVERRIDES,
    }

    def rate(K_P: float) -> float:
        push, name = bench.push(0.3, 1.8, 0.5, 0.1), f"critical_{K_P:g}"
        log = bench.on_bus(context, name, gains(K_P), [push], 6.0, **robot, start_q=[UPRIGHT])
        seen = bench.truth(log, 3.0, 6.0)
        return float(np.polyfit(seen["t"], np.log(abs(seen["q"] - UPRIGHT)), 1)[0])

    return bench.zero_between(tried, [rate(K_P) for K_P in tried])


def refused_bus(context: Context, K_P: float) -> int:
    """Gains that the controller refuses when it knows the weight: one request, or none."""
    robot = changes(SPRING, GRAVITY)
    return bench.refused(
        bench.on_bus(context, f"refused_{K_P:g}", gains(K_P), [], 1.5, changes=robot)
    )
