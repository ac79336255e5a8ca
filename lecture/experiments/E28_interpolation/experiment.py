"""How fast the goal gets on its way, and that the arm keeps up with it."""

import numpy as np
from numpy.linalg import norm
from scipy.spatial.transform import Rotation

from limber_lecture.context import Comparison, Context, at_most
from limber_lecture.pictures import BLACK, BLUE, MEASURED, ORANGE, name_axes, note
from limber_lecture.truth import motion, status, time_s

TITLE = "A smooth goal: its greatest speed and acceleration follow from distance and time"
CLAIM = "A minimum-jerk goal peaks at 1.875 Δ/T in speed and (10/√3) Δ/T² in acceleration"
SECTION = "2"
PLANT = "ideal7 with its controller, driver and simulator, cartesian_impedance"
FAST = True

K = 1000.0  # N/m
START, T = 2.0, 2.0  # s
OFFSET = np.array([0.10, 0.20, -0.10])  # m
TURN = np.array([0.2, -0.5, 0.3])  # rad
SPEED, ACCELERATION = 1.875, 10 / np.sqrt(3)
# Asked for sooner than the goal may move: then it takes as long as its greatest speed wants
HURRY_AT, FASTEST = 5.0, 1.0  # s, m/s


def run(context: Context) -> list[Comparison]:
    gains = {
        "law": "cartesian_impedance",
        "K_x_translation_N_per_m": K,
        "inertia_feedforward": True,
    }
    goals = [
        {"at_s": START, "goal": {"offset_m": OFFSET, "offset_rad": TURN, "duration_s": T}},
        {"at_s": HURRY_AT, "goal": {"offset_m": -OFFSET, "offset_rad": -TURN, "duration_s": 0.05}},
    ]
    log = context.run_law("run", "ideal7", gains, goals, 6.9, integrator="ode")
    goal = status(log, START - 0.1, START + T + 0.9)
    hurried = status(log, HURRY_AT - 0.1, HURRY_AT + 1.5)
    arm = motion(log, START - 0.1, START + T + 0.9)
    draw(context, goal, arm)

    path = norm(OFFSET)
    speed = norm(arm["V_BT"][:, :3], axis=1).max()
    hurry = derivatives(hurried["p_BD"], hurried)[0].max()
    force = norm(goal["F_law"][:, :3], axis=1).max()
    jump = "force of the law, where a goal that jumps would ask for"
    return [
        *goal_checks(goal),
        Comparison("peak speed of the arm", SPEED * path / T, speed, "m/s", 0.01),
        Comparison("peak speed of a goal in a hurry", FASTEST, hurry, "m/s", 2e-3),
        at_most(jump, K * path, force, "N"),
    ]


def goal_checks(goal: np.ndarray) -> list[Comparison]:
    found = []
    for name, values, delta, unit in (
        ("", goal["p_BD"], norm(OFFSET), "m"),
        ("turning ", turned(goal), norm(TURN), "rad"),
    ):
        v, a = (float(size.max()) for size in derivatives(values, goal))
        title = f"peak {name}speed of the goal"
        found.append(Comparison(title, SPEED * delta / T, v, f"{unit}/s", 1e-3))
        title = f"peak {name}acceleration of the goal"
        found.append(Comparison(title, ACCELERATION * delta / T**2, a, f"{unit}/s²", 1e-3))
    return found


def turned(rows: np.ndarray) -> np.ndarray:
    """Rotation vector of the goal since the first row; its axis does not change on the way."""
    R = Rotation.from_quat(rows["quat_BD"], scalar_first=True)
    return (R * R[0].inv()).as_rotvec()


def derivatives(x: np.ndarray, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Size of the first and second central difference in time, without both ends."""
    h = np.diff(time_s(rows)).mean()
    first = (x[2:] - x[:-2]) / (2 * h)
    second = (x[2:] - 2 * x[1:-1] + x[:-2]) / h**2
    return norm(first, axis=1), norm(second, axis=1)


def draw(context: Context, goal: np.ndarray, arm: np.ndarray) -> None:
    t, distance = time_s(goal) - START, norm(OFFSET)
    covered = norm(goal["p_BD"] - goal["p_BD"][0], axis=1)
    moved = norm(arm["p_BT"] - goal["p_BD"][0], axis=1)
    v, a = derivatives(goal["p_BD"], goal)
    panels = [
        ("way covered (m)", "Δ", distance, (t, covered)),
        ("speed (m/s)", "1.875 Δ/T", SPEED * distance / T, (t[1:-1], v)),
        ("acceleration (m/s²)", "(10/√3) Δ/T²", ACCELERATION * distance / T**2, (t[1:-1], a)),
    ]
    felt = [moved, norm(arm["V_BT"][:, :3], axis=1), None]
    with context.picture(TITLE, columns=3, size=(13.0, 4.6)) as axes:
        for ax, panel, curve, arms in zip(axes, panels, minimum_jerk(t), felt, strict=True):
            unit, name, peak, (at, values) = panel
            if arms is not None:
                style = {"color": ORANGE, "lw": 5, "alpha": 0.5}
                ax.plot(time_s(arm) - START, arms, **style, label="tip of the arm")
            ax.plot(t, distance * curve, color=BLUE, lw=1.2, label="minimum jerk")
            ax.plot(at[::15], values[::15], **MEASURED, color=BLUE, label="goal, from the log")
            ax.axhline(peak, color=BLACK, ls="--", lw=1.2)
            note(ax, name, (2.85, peak), (0, 4), ha="right", color=BLACK)
            name_axes(ax, "time since the request (s)", unit)
            ax.set_ylim(0, 1.1 * peak)
        axes[0].legend(loc="lower right")


def minimum_jerk(t: np.ndarray) -> list[np.ndarray]:
    """Way, speed and size of the acceleration for a way of 1 in T."""
    x = np.clip(t / T, 0.0, 1.0)
    way = x**3 * (10 - 15 * x + 6 * x**2)
    return [way, 30 * x**2 * (1 - x) ** 2 / T, np.abs(60 * x * (1 - x) * (1 - 2 * x)) / T**2]
