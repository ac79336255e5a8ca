"""How far the hand goes under forces and moments, and whether the way back gives all of it back."""

import numpy as np
from numpy.linalg import norm

from limber.model.rotations import rotation_error
from limber_lecture.context import Comparison, Context, near_zero
from limber_lecture.pictures import BLACK, BLUE, GREEN, MEASURED, ORANGE, Axes, name_axes
from limber_lecture.timeline import UNBOUNDED, in_turn, tip_gains
from limber_lecture.truth import Log, motion, status

from . import turn

TITLE = "The hand is the spring that was asked for, and an honest one with the right error rate"
CLAIM = "Cartesian impedance control makes the tip a spring, K⁻¹ times the force, in six directions"
SECTION = "2"
PLANT = "ideal7 with its controller, driver and simulator, exact equations; cartesian_impedance"
FAST = False

# Elbow well bent: a turn of a radian about any axis stays within the arm's reach
START_Q = [0.0, 0.4, 0.0, -1.8, 0.0, 0.5, 0.0]
K, K_TURN = 1000.0, 30.0  # N/m, N m/rad
FORCE = np.array([10.0, -20.0, 15.0])  # N
MOMENT, AXIS = 15.0, np.array([1.0, 2.0, 2.0]) / 3  # N m
SHARES = [0.5, 1.0, 1.5]
FIRST_AT, EACH_S = 2.0, 2.4

# Angle under a moment μ of equal springs k, as a function of μ/k
ANGLES = {
    "log": lambda x: x,
    "quat": np.arcsin,
    "log_simple": lambda x: x,
    "quat_simple": lambda x: 2 * np.arcsin(x / 2),
}


def run(context: Context) -> list[Comparison]:
    logs = {mode: pushed(context, mode) for mode in ANGLES}
    works = {mode: turn.net_work(context, START_Q, mode) for mode in ANGLES}
    with context.picture(TITLE, columns=3, size=(14.5, 4.9)) as (left, middle, right):
        draw_forces(left, logs["log"])
        draw_moments(middle, logs)
        draw_works(right, works)
    return [*forces(logs["log"]), *moments(logs), *turn.checks(works)]


def pushed(context: Context, mode: str) -> Log:
    """Three forces, then three moments, each until the arm rests."""
    pushes = [{"force_N": share * FORCE} for share in SHARES]
    pushes += [{"torque_Nm": share * MOMENT * AXIS} for share in SHARES]
    gains = tip_gains(K, K_TURN, orientation=mode, **UNBOUNDED)
    entries = in_turn(FIRST_AT, EACH_S, pushes, ramp_s=0.3, for_s=EACH_S)
    end = FIRST_AT + EACH_S * len(pushes)
    return context.run_law(mode, "ideal7", gains, entries, end, start_q=START_Q)


def rest(log: Log, push: int) -> tuple[np.ndarray, np.ndarray]:
    """Deviation from the goal before the push goes: m, and a rotation vector, rad."""
    end = FIRST_AT + EACH_S * (push + 1) - 0.3
    goal = status(log, end - 1.0, end)[-1]
    last = motion(log, end - 0.02, end)[-1]
    turned = rotation_error(last["quat_BT"][None], goal["quat_BD"][None])[0]
    return last["p_BT"] - goal["p_BD"], turned


def forces(log: Log) -> list[Comparison]:
    moved, turned = rest(log, SHARES.index(1.0))
    found = [
        Comparison(f"tip moved along {axis}", FORCE[i] / K * 1e3, moved[i] * 1e3, "mm", 0.01)
        for i, axis in enumerate("xyz")
    ]
    return [*found, near_zero("tip turned by a force", norm(turned) * 1e3, "mrad", 0.1)]


def moments(logs: dict[str, Log]) -> list[Comparison]:
    found = []
    for mode, log in logs.items():
        for i, share in enumerate(SHARES):
            moment = share * MOMENT
            moved, turned = rest(log, len(SHARES) + i)
            name = f"tip turned by {moment:g} N m, {mode}"
            angle = ANGLES[mode](moment / K_TURN)
            found.append(Comparison(name, angle, turned @ AXIS, "rad", 0.01))
        found.append(near_zero(f"tip moved by a moment, {mode}", norm(moved) * 1e3, "mm", 0.1))
    return found


def draw_forces(ax: Axes, log: Log) -> None:
    for i, (axis, color) in enumerate(zip("xyz", (BLUE, ORANGE, GREEN), strict=True)):
        applied = FORCE[i] * np.array([0.0, *SHARES])
        moved = [0.0] + [rest(log, k)[0][i] * 1e3 for k in range(len(SHARES))]
        ax.plot(applied, applied / K * 1e3, color=color, label=f"along {axis}: force / stiffness")
        ax.plot(applied, moved, **MEASURED, color=color)
    ax.set_title("Pushed (circles: measured)")
    name_axes(ax, "force (N)", "tip moved (mm)", "upper left")


def draw_moments(ax: Axes, logs: dict[str, Log]) -> None:
    fine = np.linspace(0.0, max(SHARES) * MOMENT, 60)
    applied = MOMENT * np.array(SHARES)
    for mode, name, color in (
        ("log", "angle: μ/k", BLUE),
        ("quat_simple", "half angle: 2 asin(μ/2k)", GREEN),
        ("quat", "sine: asin(μ/k)", ORANGE),
    ):
        turned = [rest(logs[mode], len(SHARES) + i)[1] @ AXIS for i in range(len(SHARES))]
        ax.plot(fine, ANGLES[mode](fine / K_TURN), color=color, label=name)
        ax.plot(applied, turned, **MEASURED, color=color)
    ax.set_title("Turned: three ways to measure the error")
    name_axes(ax, "moment μ (N m)", "tip turned (rad)", "upper left")


def draw_works(ax: Axes, works: dict[str, float]) -> None:
    modes = ("log", "quat", "log_simple", "quat_simple")
    names = ["angle", "sine", "angle, its rate\nleft out", "half angle, its\nrate left out"]
    colors = (BLUE, BLUE, ORANGE, ORANGE)
    heights, measured = [-turn.turn_work(mode) for mode in modes], [-works[mode] for mode in modes]
    bars = ax.bar(names, heights, width=0.5, color=colors, alpha=0.6)
    ax.bar_label(bars, [f"{work:.2f} J" for work in measured], padding=8)
    ax.plot(names, measured, **MEASURED, color=BLACK, clip_on=False)
    ax.set_title("Work that a closed turn gains from the spring")
    ax.set_ylabel("energy from nowhere (J)")
    ax.set_ylim(0, 1.2 * max(measured))
