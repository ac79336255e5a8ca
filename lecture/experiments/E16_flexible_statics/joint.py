"""One soft joint: what stiffness its link shows under laws that see the motor only."""

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

from limber_lecture import testbench as bench
from limber_lecture.context import Context

SPRING = 1000.0  # N m/rad, of the joint
K, D = 500.0, 40.0  # N m/rad, N m s/rad, of the law
GRAVITY, ANGLE = 15.0, 0.7  # m/s², rad from hanging
PUSH_NM = 4.0
ASKED = (100.0, 500.0, 900.0)  # N m/rad, of the law on the link at rest

Law = Callable[[float, float], float]


def series(K_P: float) -> float:
    return 1 / (1 / K_P + 1 / SPRING)


def weight(q: float) -> float:
    return bench.weight(q, GRAVITY)


def gradient() -> float:
    """∂g/∂q."""
    return GRAVITY * bench.LINK_MASS_M * np.cos(ANGLE)


def on_motor(theta: float, theta_dot: float) -> float:
    """A spring from the motor to its goal, without gravity."""
    return -K * theta - D * theta_dot


def tomei(theta: float, theta_dot: float) -> float:
    """Gravity's torque at the goal, whatever the angle."""
    carried = weight(ANGLE)
    return carried - K * (theta - ANGLE - carried / SPRING) - D * theta_dot


def static(K_d: float) -> Law:
    """l(q̄) = g(q̄) - K_d (q̄ - q_d) where the link rests, K_J (θ - q̄) = l(q̄)."""

    def law(theta: float, theta_dot: float) -> float:
        return wanted(rest(theta, K_d), K_d) - D * theta_dot

    return law


def wanted(q: float, K_d: float) -> float:
    return weight(q) - K_d * (q - ANGLE)


def rest(theta: float, K_d: float) -> float:
    """q̄, by Newton."""
    q = theta
    for _ in range(6):
        slope = GRAVITY * np.cos(q) - K_d + SPRING
        q -= (wanted(q, K_d) - SPRING * (theta - q)) / slope
    return q


def fixpoint_steps(K_d: float, count: int = 4) -> list[float]:
    """|q̄₊ - q̄| of q̄ ← θ - l(q̄)/K_J, near the goal."""
    theta = ANGLE + weight(ANGLE) / SPRING + 1e-6
    q, steps = ANGLE, []
    for _ in range(count):
        before, q = q, theta - wanted(q, K_d) / SPRING
        steps.append(abs(q - before))
    return steps


def stiffness_model(law: Law, gravity: float, start: float) -> float:
    """Push over how far the link moves, on the joint's equations until they rest."""
    ends = [_settle(law, gravity, start, push) for push in (0.0, PUSH_NM)]
    return PUSH_NM / (ends[1] - ends[0])


def _settle(law: Law, gravity: float, start: float, push: float) -> float:
    A, inputs = bench.elastic(SPRING)

    def rate(_: float, x: np.ndarray) -> np.ndarray:
        on_link = push - bench.weight(x[0], gravity)
        return A @ x + inputs @ [law(x[2], x[3]), on_link]

    carried = bench.weight(start, gravity) / SPRING
    start_state = [start, 0.0, start + carried, 0.0]
    tight = {"rtol": 1e-8, "atol": 1e-11, "method": "LSODA"}
    return float(solve_ivp(rate, (0.0, 4.0), start_state, **tight).y[0, -1])


def stiffness_bus(context: Context, name: str, gains: dict, gravity: float) -> float:
    """The same on the bus."""
    push, start = bench.push(PUSH_NM, 3.0, 4.0, 0.5), [ANGLE if gravity else 0.0]
    changes = _changes(gravity)
    log = bench.on_bus(context, name, gains, [push], 6.4, changes=changes, start_q=start)
    return PUSH_NM / (bench.mean(log, 5.5, 6.4) - bench.mean(log, 2.5, 2.99))


def refused_bus(context: Context, K_d: float) -> int:
    """1: the controller does not take a request for such a stiffness at rest, else 0."""
    gains = {**bench.spring_damper(K_d, D), "position_feedback": "static"}
    log = bench.on_bus(context, f"asked_{K_d:g}", gains, [], 1.5, changes=_changes(GRAVITY))
    return bench.refused(log)


def _changes(gravity: float) -> dict:
    return {**bench.gravity(gravity), **bench.sprung(SPRING)}
