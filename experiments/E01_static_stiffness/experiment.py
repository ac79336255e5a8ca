"""How far the hand goes under forces and moments, and whether the way back gives all of it back."""

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from limber.experiments.check import Check
from limber.experiments.context import Context
from limber.experiments.pictures import BLACK, BLUE, GREEN, MEASURED, ORANGE
from limber.experiments.truth import motion, status
from limber.logs import Log

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


def run(context: Context) -> list[Check]:
    logs = {mode: context.lab(scenario(mode), mode) for mode in ANGLES}
    works = turn.run_turns(context, START_Q, list(ANGLES))
    with context.picture(TITLE, columns=3, size=(14.5, 4.9)) as (left, middle, right):
        draw_forces(left, logs["log"])
        draw_moments(middle, logs)
        draw_works(right, works)
    return [*forces(logs["log"]), *moments(logs), *turn.checks(works)]


def scenario(mode: str) -> dict[str, Any]:
    """Three forces, then three moments, each until the arm rests."""
    pushes = [{"force_N": (share * FORCE).tolist()} for share in SHARES]
    pushes += [{"torque_Nm": (share * MOMENT * AXIS).tolist()} for share in SHARES]
    gains = {
        "law": "cartesian_impedance",
        "orientation": mode,
        "K_x_translation_N_per_m": K,
        "K_x_rotation_Nm_per_rad": K_TURN,
        "spring_force_N": 1000.0,
        "spring_moment_Nm": 1000.0,
    }
    return {
        "robot": "ideal7",
        "duration_s": FIRST_AT + EACH_S * len(pushes),
        "integrator": "reference",
        "start_q": START_Q,
        "timeline": [
            {"at_s": 0.3, "mode": "hold"},
            {"at_s": 0.8, "mode": "active"},
            {"at_s": 1.0, "gains": gains},
            *(
                {"at_s": FIRST_AT + EACH_S * i, "push": {**push, "ramp_s": 0.3, "for_s": EACH_S}}
                for i, push in enumerate(pushes)
            ),
        ],
    }


def rest(log: Log, push: int) -> tuple[np.ndarray, np.ndarray]:
    """Deviation from the goal before the push goes: m, and a rotation vector, rad."""
    end = FIRST_AT + EACH_S * (push + 1) - 0.3
    goal = status(log, end - 1.0, end)[-1]
    last = motion(log, end - 0.02, end)[-1]
    R, R_d = (Rotation.from_quat(row[key], scalar_first=True)
              for row, key in ((last, "quat_BT"), (goal, "quat_BD")))  # fmt: skip
    return last["p_BT"] - goal["p_BD"], (R * R_d.inv()).as_rotvec()


def forces(log: Log) -> list[Check]:
    moved, turned = rest(log, SHARES.index(1.0))
    found = [
        Check(f"tip moved along {axis}", FORCE[i] / K * 1e3, moved[i] * 1e3, "mm", 0.01)
        for i, axis in enumerate("xyz")
    ]
    off = float(np.linalg.norm(turned)) * 1e3
    return [*found, Check("tip turned by a force", 0.0, off, "mrad", 0.1, "absolute")]


def moments(logs: dict[str, Log]) -> list[Check]:
    found = []
    for mode, log in logs.items():
        for i, share in enumerate(SHARES):
            moment = share * MOMENT
            moved, turned = rest(log, len(SHARES) + i)
            angle = float(ANGLES[mode](moment / K_TURN))
            name = f"tip turned by {moment:g} N m, {mode}"
            found.append(Check(name, angle, float(turned @ AXIS), "rad", 0.01))
        off = float(np.linalg.norm(moved)) * 1e3
        found.append(Check(f"tip moved by a moment, {mode}", 0.0, off, "mm", 0.1, "absolute"))
    return found


def draw_forces(ax: Any, log: Log) -> None:
    for i, (axis, color) in enumerate(zip("xyz", (BLUE, ORANGE, GREEN), strict=True)):
        applied = FORCE[i] * np.array([0.0, *SHARES])
        moved = [0.0] + [rest(log, k)[0][i] * 1e3 for k in range(len(SHARES))]
        ax.plot(applied, applied / K * 1e3, color=color, label=f"along {axis}: force / stiffness")
        ax.plot(applied, moved, **MEASURED, color=color)
    ax.set_title("Pushed (circles: measured)")
    ax.set_xlabel("force (N)")
    ax.set_ylabel("tip moved (mm)")
    ax.legend(loc="upper left")


def draw_moments(ax: Any, logs: dict[str, Log]) -> None:
    fine = np.linspace(0.0, max(SHARES) * MOMENT, 60)
    applied = MOMENT * np.array(SHARES)
    names = {"log": "angle: μ/k", "quat_simple": "half angle: 2 asin(μ/2k)",
             "quat": "sine: asin(μ/k)"}  # fmt: skip
    for (mode, name), color in zip(names.items(), (BLUE, GREEN, ORANGE), strict=True):
        turned = [rest(logs[mode], len(SHARES) + i)[1] @ AXIS for i in range(len(SHARES))]
        ax.plot(fine, ANGLES[mode](fine / K_TURN), color=color, label=name)
        ax.plot(applied, turned, **MEASURED, color=color)
    ax.set_title("Turned: three ways to measure the error")
    ax.set_xlabel("moment μ (N m)")
    ax.set_ylabel("tip turned (rad)")
    ax.legend(loc="upper left")


def draw_works(ax: Any, works: dict[str, float]) -> None:
    names = {"log": "angle", "quat": "sine", "log_simple": "angle, its rate\nleft out",
             "quat_simple": "half angle, its\nrate left out"}  # fmt: skip
    colors = (BLUE, BLUE, ORANGE, ORANGE)
    bars = ax.bar(list(names.values()), [-turn.turn_work(mode) for mode in names], width=0.5,
                  color=colors, alpha=0.6)  # fmt: skip
    ax.bar_label(bars, [f"{-works[mode]:.2f} J" for mode in names], padding=8)
    measured = [-works[mode] for mode in names]
    ax.plot(list(names.values()), measured, **MEASURED, color=BLACK, clip_on=False)
    ax.set_title("Work that a closed turn gains from the spring")
    ax.set_ylabel("energy from nowhere (J)")
    ax.set_ylim(0, 1.2 * max(measured))
