"""Eq. 8 and Eq. 9: joints that drag each other along, and joints that do not.

Torques come a cycle late and are held for one, which the formulas leave out: the overshoot is 2 %
larger than predicted.
"""

import numpy as np

from limber_lecture import planar2r as arm
from limber_lecture.context import Comparison, Context, at_least, at_most
from limber_lecture.pictures import BLACK, BLUE, MEASURED, ORANGE, Axes, name_axes
from limber_lecture.truth import Log, joints, motion, status, time_s

from . import scenarios as s
from .planar import move, resting

TITLE = "A model in the loop (Eq. 9) keeps the joints apart and on their path; a PD (Eq. 8) does"
TITLE += " not"
CLAIM = "Eq. 7 alone is a joint PD with low gains and all its problems, which Eq. 9 cures; the"
CLAIM += " desired joint velocity can be left out"
SECTION = "3"
PLANT = "planar2r with its controller, driver and simulator, exact equations; joint_pd,"
PLANT += " mapped_joint_impedance, computed_torque"
FAST = False

CIRCLES = {
    "Eq. 9": s.EQ_9,
    "Eq. 8": s.EQ_8,
    "Eq. 8 as printed": s.EQ_8_PRINTED,
    "Eq. 7": s.EQ_7,
    "Eq. 7 without q̇_d": s.EQ_7_AT_REST,
}


def run(context: Context) -> list[Comparison]:
    off = np.array([-s.STEP, 0.0])
    steps = {
        "Eq. 9": s.step(context, "step_eq9", s.EQ_9, s.M @ (s.K_ACC * off)),
        "Eq. 8": s.step(context, "step_eq8", s.EQ_8, s.K_Q * off),
    }
    circles = {
        name: s.circle(context, f"circle_{i}", gains)
        for i, (name, gains) in enumerate(CIRCLES.items())
    }
    contacts = {
        "Eq. 9": s.contact(context, "contact_eq9", s.EQ_9),
        "Eq. 9 with JᵀKJ": s.contact(context, "contact_literal", s.EQ_9_LITERAL),
    }
    draw(context, steps, circles)
    return [*step_checks(steps), *circle_checks(circles), *contact_checks(contacts)]


def let_go(log: Log) -> tuple[np.ndarray, np.ndarray]:
    """Time since, and q - q_d from then on, rad."""
    status(log, s.LET_GO_AT, s.LET_GO_AT + 3.0)
    rows = motion(log, s.LET_GO_AT, s.LET_GO_AT + 3.0)
    return time_s(rows) - s.LET_GO_AT, joints(rows) - s.Q_D


def pd_let_go(times: np.ndarray) -> np.ndarray:
    """The same from the equations of motion under Eq. 8."""
    start = np.concatenate([s.Q_D - [s.STEP, 0.0], np.zeros(2)])
    return move(s.K_Q, s.D_Q, resting(s.Q_D), start, times)[:, :2] - s.Q_D


def step_checks(steps: dict[str, Log]) -> list[Comparison]:
    t, eq9 = let_go(steps["Eq. 9"])
    _, eq8 = let_go(steps["Eq. 8"])
    overshoot = np.exp(-np.pi * s.ZETA / np.sqrt(1 - s.ZETA**2))
    dragged, eq8_off, eq9_off = (np.abs(q[:, 1]).max() * 1e3 for q in (pd_let_go(t), eq8, eq9))
    return [
        Comparison("elbow dragged along, Eq. 8", dragged, eq8_off, "mrad", 0.05),
        at_most("elbow dragged along, Eq. 9", 2.0, eq9_off, "mrad"),
        Comparison("held away by", s.STEP, -eq9[0, 0], "rad", 1e-3),
        Comparison("overshoot, Eq. 9", overshoot, eq9[:, 0].max() / s.STEP, "", 0.04),
    ]


def on_path(log: Log) -> np.ndarray:
    """The last turns: rows of CONTROLLER_STATUS."""
    end = s.CIRCLE_AT + (s.TURNS + 1) * s.PERIOD_S
    return status(log, end - 3 * s.PERIOD_S, end)


def path_error(log: Log) -> float:
    """Root of the mean square, m."""
    rows = on_path(log)
    return float(np.sqrt(np.mean(np.sum((rows["p_BT"] - rows["p_BD"]) ** 2, axis=1))))


def pd_path_error() -> float:
    """The same from the equations of motion under Eq. 8, once the start is forgotten."""
    times = np.linspace(0.0, 8.0, 1601)
    q_d, v_d = target(0.0)
    q = move(s.K_Q, s.D_Q, target, np.concatenate([q_d, v_d]), times)[-601:, :2]
    off = [arm.tip(pose) - circle_at(t) for pose, t in zip(q, times[-601:], strict=True)]
    return float(np.sqrt(np.mean(np.sum(np.square(off[:-1]), axis=1))))


def circle_at(t: float) -> np.ndarray:
    angle = 2 * np.pi * t / s.PERIOD_S
    return s.CENTRE + s.RADIUS * np.array([np.cos(angle), np.sin(angle)])


def target(t: float) -> tuple[np.ndarray, np.ndarray]:
    """Joint angles and velocities that lead the tip around the circle."""
    q = arm.inverse(circle_at(t))
    v = 2 * np.pi / s.PERIOD_S * arm.across(circle_at(t) - s.CENTRE)
    return q, np.linalg.solve(arm.jacobian(q), v)


def circle_checks(circles: dict[str, Log]) -> list[Comparison]:
    errors = {name: path_error(log) * 1e3 for name, log in circles.items()}
    worse = errors["Eq. 8"] / errors["Eq. 9"]
    rest = errors["Eq. 7 without q̇_d"] / errors["Eq. 7"]
    printed = errors["Eq. 8 as printed"] / errors["Eq. 8"]
    return [
        Comparison("path error, Eq. 8", pd_path_error() * 1e3, errors["Eq. 8"], "mm", 0.03),
        at_least("path error, Eq. 8 over Eq. 9", 20.0, worse),
        at_least("path error without over with gravity term, Eq. 8", 1.0, printed),
        at_least("path error without over with q̇_d, Eq. 7", 1.0, rest),
    ]


def contact_checks(contacts: dict[str, Log]) -> list[Comparison]:
    """J⁻ᵀ M K J⁻¹, entry by entry; not symmetric with K = JᵀK_x J."""
    J = arm.jacobian(s.Q_D)
    inverse = np.linalg.inv(J)
    gains = {"Eq. 9": s.K_ACC * np.eye(2), "Eq. 9 with JᵀKJ": s.K_X * J.T @ J}
    found = []
    for name, K in gains.items():
        predicted = inverse.T @ s.M @ K @ inverse
        measured = s.PROBING.stiffness(contacts[name])
        tolerance = 0.03 * float(np.abs(predicted).max())
        for i, j in np.ndindex(2, 2):
            title = f"contact stiffness {'xy'[i]}{'xy'[j]}, {name}"
            values = predicted[i, j], measured[i, j]
            found.append(Comparison(title, *values, "N/m", tolerance, "absolute"))
    return found


def draw(context: Context, steps: dict[str, Log], circles: dict[str, Log]) -> None:
    with context.picture(TITLE, columns=2, size=(13.0, 5.6)) as (left, right):
        draw_steps(left, steps)
        draw_circles(right, circles)


def draw_steps(ax: Axes, steps: dict[str, Log]) -> None:
    t, eq8 = let_go(steps["Eq. 8"])
    _, eq9 = let_go(steps["Eq. 9"])
    omega = np.sqrt(s.K_ACC * (1 - s.ZETA**2))
    decay = -s.ZETA * np.sqrt(s.K_ACC)
    swing = np.cos(omega * t) - decay / omega * np.sin(omega * t)
    eq9_formula = np.column_stack([-s.STEP * np.exp(decay * t) * swing, 0 * t])
    for name, color, formula, measured in (
        ("Eq. 9", BLUE, eq9_formula, eq9),
        ("Eq. 8", ORANGE, pd_let_go(t), eq8),
    ):
        for joint, style in enumerate(("-", "--")):
            name_of_joint = f"{name}, {('shoulder', 'elbow')[joint]}"
            ax.plot(t, formula[:, joint], style, color=color, label=name_of_joint)
            ax.plot(t[::40], measured[::40, joint], **{**MEASURED, "ms": 4}, color=color)
    ax.set_xlim(0, 1.2)
    ax.set_title("Only the shoulder was held away; let go at 0 (circles: measured)")
    name_axes(ax, "time (s)", "joint off its target (rad)", "lower right")


def draw_circles(ax: Axes, circles: dict[str, Log]) -> None:
    around = np.linspace(0.0, 1.0, 100)
    ax.plot(*np.array([circle_at(t) for t in around]).T, color=BLACK, ls="--", lw=3, label="asked")
    for name, color in (("Eq. 9", BLUE), ("Eq. 8", ORANGE)):
        rows = on_path(circles[name])
        off = path_error(circles[name]) * 1e3
        ax.plot(*rows["p_BT"][:, :2].T, color=color, label=f"{name}: {off:.2g} mm off")
    ax.set_aspect("equal")
    ax.set_title("A circle of 10 cm, one turn a second")
    ax.set_ylim(0.38, 0.78)
    name_axes(ax, "x (m)", "y (m)", "upper left")
