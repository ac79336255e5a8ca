"""How wrong the stiffness gets while the arm moves on between two evaluations of its gains."""

import math

import numpy as np
from numpy.linalg import norm

from limber_lecture import planar2r as arm
from limber_lecture.context import Comparison, Context, case
from limber_lecture.pictures import AMBER, BLUE, GREEN, MEASURED, ORANGE, Axes, level, name_axes
from limber_lecture.search import order

from . import times

TITLE = "Gains evaluated too rarely: the stiffness errs by what the arm has moved since"
CLAIM = "K_p and K_v have to be re-evaluated at the present pose all the time, and there are"
CLAIM += " schemes that play with the rates"
SECTION = "2"
PLANT = "the controller's laws on planar2r"
FAST = True

Q = np.array([0.5, 1.0])
K = np.diag([1000.0, 100.0])
SHOULDER_RAD_PER_S, ELBOW_RAD_PER_S = 2.0, 2.0
TARGET = arm.tip(Q) - np.array([0.03, 0.02])  # so that the spring carries a force
MOTION = np.array([1.0, -1.5])  # rad/s


def run(context: Context) -> list[Comparison]:
    checks = []
    for ms in (1.0, 10.0, 50.0):
        moved = np.array([SHOULDER_RAD_PER_S * ms * 1e-3, 0.0])
        (off,) = held_errors(context, [moved])
        name = f"shoulder at 2 rad/s, J held {ms:g} ms: stiffness off by"
        checks.append(Comparison(name, shoulder_error(ms * 1e-3), off, "N/m", 1e-3))
    for ms in (1.0, 4.0):
        (off,) = held_errors(context, [np.array([0.0, ELBOW_RAD_PER_S * ms * 1e-3])])
        name = f"elbow at 2 rad/s, J held {ms:g} ms: stiffness off by"
        checks.append(Comparison(name, elbow_error(ms * 1e-3), off, "N/m", 0.05))
    holds = np.geomspace(1e-3, 16e-3, 5)
    full, first = torque_errors(context, holds)
    for name, errors, power in (("full tangent", full, 2.0), ("first term only", first, 1.0)):
        name = f"order of the torque error in time, {name}"
        checks.append(Comparison(name, power, order(holds, errors), "", 0.1, "absolute"))
    found = times.measure(context)
    draw(context, found)
    return [*checks, *times.checks(found)]


def shoulder_error(T: float) -> float:
    """|k₁ - k₂| sin(ω T): the shoulder turns the held stiffness ellipse as a whole."""
    return abs(K[0, 0] - K[1, 1]) * math.sin(SHOULDER_RAD_PER_S * T)


def elbow_error(T: float) -> float:
    """‖EᵀK + K E‖ with E = (∂J/∂q₂) J⁻¹ ω T, first order in what the elbow has moved."""
    rate = arm.jacobian_rate(Q, np.array([0.0, ELBOW_RAD_PER_S]))
    E = rate @ np.linalg.inv(arm.jacobian(Q)) * T
    return norm(E.T @ K + K @ E, 2)


def held_errors(context: Context, moves: list[np.ndarray]) -> list[float]:
    """‖J⁻ᵀ K_q J⁻¹ - K‖ with K_q from before the move and J from after it."""
    old = case("eq4", arm.ROBOT, q=Q, p_d=arm.tip(Q), Kx=K, mode="log")
    now = [case("kin_dyn", arm.ROBOT, q=Q + move, v=[0.0, 0.0], W=[0.0, 0.0]) for move in moves]
    first, *poses = context.eval([old, *now])
    errors = []
    for pose in poses:
        inverse = np.linalg.inv(pose["J"])
        errors.append(norm(inverse.T @ first["first"] @ inverse - K, 2))
    return errors


def torque_errors(context: Context, holds: np.ndarray) -> tuple[list[float], list[float]]:
    """|τ - (τ_k - K_k Δq)| for K_k the full tangent, and for its first term JᵀKJ alone."""
    poses = [Q, *(Q + MOTION * hold for hold in holds)]
    tangent = case("eq4", arm.ROBOT, q=Q, p_d=TARGET, Kx=K, mode="log")
    at_rest = np.zeros(2), TARGET, K, np.eye(2)
    laws = [arm.direct_law(q, *at_rest) for q in poses]
    slow, start, *exact = context.eval([tangent, *laws])
    errors = []
    for name in ("full", "first"):
        held = [start["tau"] - slow[name] @ (q - Q) for q in poses[1:]]
        errors.append([norm(law["tau"] - tau) for law, tau in zip(exact, held, strict=True)])
    return errors[0], errors[1]


def draw(context: Context, found: dict[str, float]) -> None:
    holds = np.geomspace(0.5e-3, 100e-3, 40)
    some = np.geomspace(0.5e-3, 100e-3, 9)
    columns = 3 if found else 2
    with context.picture(TITLE, columns=columns, size=(5.9 * columns, 5.0)) as (left, right, *last):
        draw_stiffness(context, left, holds, some)
        for ax in last:
            times.draw(found, ax)
        full, first = torque_errors(context, some)
        right.loglog(some * 1e3, first, **MEASURED, color=AMBER, label="first term of Eq. 4 held")
        right.loglog(some * 1e3, full, **MEASURED, color=GREEN, label="full tangent held")
        right.loglog(holds * 1e3, first[2] * holds / some[2], color=AMBER, label="slope 1")
        right.loglog(holds * 1e3, full[2] * (holds / some[2]) ** 2, color=GREEN, label="slope 2")
        right.set_title("Torque from a tangent that is renewed slowly")
        name_axes(right, "time since the last evaluation (ms)", "torque error (N m)", "upper left")


def draw_stiffness(context: Context, ax: Axes, holds: np.ndarray, some: np.ndarray) -> None:
    for speed, formula, color, name in (
        ([SHOULDER_RAD_PER_S, 0.0], shoulder_error, BLUE, "shoulder turns: |k₁ - k₂| sin ωt"),
        ([0.0, ELBOW_RAD_PER_S], elbow_error, ORANGE, "elbow turns: ‖EᵀK + KE‖"),
    ):
        ax.loglog(holds * 1e3, [formula(T) for T in holds], color=color, label=name)
        found = held_errors(context, [np.array(speed) * T for T in some])
        ax.loglog(some * 1e3, found, **MEASURED, color=color)
    ax.loglog([], [], **MEASURED, color="0.3", label="from the controller's terms")
    level(ax, "1 % of the greater stiffness", (0.5, 0.01 * K[0, 0]), (0, 3))
    ax.set_title("J held while a joint turns at 2 rad/s")
    name_axes(
        ax, "time since the last evaluation (ms)", "error of the stiffness (N/m)", "upper left"
    )
