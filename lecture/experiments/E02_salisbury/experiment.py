"""What stiffness control gives way to, and what position control does not."""

from typing import Any

import numpy as np
from scipy.optimize import fsolve

from limber_lecture import planar2r as arm
from limber_lecture.context import Comparison, Context, near_zero
from limber_lecture.pictures import BLACK, BLUE, GREEN, MEASURED, ORANGE, Axes
from limber_lecture.timeline import joint_damping
from limber_lecture.truth import Log, joints, motion, status

TITLE = "Stiffness control gives way to everything, by force over stiffness"
CLAIM = "Stiffness control makes the tip a spring for small displacements; it rejects disturbances"
CLAIM += " worse than position control, and a model term takes the error of gravity away"
SECTION = "1.1"
PLANT = "planar2r with its controller, driver and simulator, exact equations; salisbury, joint_pd"
FAST = True

Q_D = np.array([0.5, 1.0])
K = 2000.0 * np.eye(2)  # N/m
K_V = [20.0, 8.0]  # N m s/rad
STIFF = 6000.0  # N m/rad
TORQUE = 2.0  # N m on the shoulder
FORCE = 4.0  # N on the tip
# When each part is at rest
HELD, PUSHED, TIP_X, TIP_Y, SAGGED = 3.0, 5.0, 7.0, 9.0, 12.0


def run(context: Context) -> list[Comparison]:
    salisbury = {"law": "salisbury", "K_x_translation_N_per_m": K[0, 0], **joint_damping(K_V)}
    joint_pd = {"law": "joint_pd", "K_q_Nm_per_rad": STIFF, "joint_damping_ratio": 0.7}
    soft, stiff = pushed(context, salisbury), pushed(context, joint_pd)
    draw(context, soft, stiff)
    return [*disturbances(soft, stiff), *tip_spring(soft), *gravity(soft, stiff)]


def pushed(context: Context, law: dict[str, Any]) -> Log:
    """Gravity compensated at first, with a push in each part, and in the end not."""

    def push(rests_at: float, **wrench: Any) -> dict[str, Any]:
        return {"at_s": rests_at - 1.4, "push": {**wrench, "ramp_s": 0.2, "for_s": 1.6}}

    gains = {**law, "model_compensation": "gravity"}
    entries = [
        {"at_s": 1.1, "goal": {"joints_rad": Q_D, "duration_s": 0.2}},
        # a moment on the first link turns no joint but the shoulder
        push(PUSHED, link="link1", torque_Nm=[0.0, 0.0, TORQUE]),
        push(TIP_X, force_N=[FORCE, 0.0, 0.0]),
        push(TIP_Y, force_N=[0.0, FORCE, 0.0]),
        {"at_s": 9.5, "gains": {"model_compensation": "none"}},
    ]
    return context.run_law(law["law"], arm.ROBOT, gains, entries, SAGGED, start_q=Q_D)


def rest(log: Log, at_s: float) -> np.ndarray:
    """q - q_d, rad, over the last 50 ms before `at_s`."""
    status(log, at_s - 0.5, at_s)
    return joints(motion(log, at_s - 0.05, at_s)).mean(axis=0) - Q_D


def K_q() -> np.ndarray:
    J = arm.jacobian(Q_D)
    return J.T @ K @ J


def yields() -> np.ndarray:
    """K_q⁻¹ τ for the torque on the shoulder."""
    return np.linalg.solve(K_q(), [TORQUE, 0.0])


def sag() -> np.ndarray:
    """Jᵀ K J q̃ = -g(q) with J and g where the arm comes to rest."""

    def torque(off: np.ndarray) -> np.ndarray:
        J = arm.jacobian(Q_D + off)
        return J.T @ K @ J @ off + arm.weight(Q_D + off)

    return fsolve(torque, np.zeros(2), xtol=1e-12)


def disturbances(soft: Log, stiff: Log) -> list[Comparison]:
    predicted, small = yields() * 1e3, TORQUE / STIFF * 1e3
    measured, held = ((rest(log, PUSHED) - rest(log, HELD)) * 1e3 for log in (soft, stiff))
    ratios = predicted[0] / small, measured[0] / held[0]
    return [
        Comparison("disturbance of 2 N m, soft over stiff", *ratios, "", 0.05),
        Comparison("shoulder gives way, Salisbury", predicted[0], measured[0], "mrad", 0.05),
        Comparison("elbow gives way, Salisbury", predicted[1], measured[1], "mrad", 0.05),
        Comparison("shoulder gives way, joint PD", small, held[0], "mrad", 0.05),
        near_zero("elbow gives way, joint PD", held[1], "mrad", 0.05 * small),
    ]


def tip_spring(soft: Log) -> list[Comparison]:
    """A small force moves the tip by K⁻¹ f, and not across."""
    moved = FORCE / K[0, 0] * 1e3
    found = []
    for name, at_s, along in (("x", TIP_X, 0), ("y", TIP_Y, 1)):
        off = (arm.tip(Q_D + rest(soft, at_s)) - arm.tip(Q_D)) * 1e3
        title = f"small displacement: tip under {FORCE:g} N along {name}"
        found.append(Comparison(title, moved, off[along], "mm", 0.01))
        found.append(near_zero(f"{title}, across", off[1 - along], "mm", 0.01 * moved))
    return found


def gravity(soft: Log, stiff: Log) -> list[Comparison]:
    fallen, predicted = rest(soft, SAGGED) * 1e3, sag() * 1e3
    left = np.abs(rest(soft, HELD)).max() * 1e6
    pd, held = -arm.weight(Q_D)[0] / STIFF * 1e3, rest(stiff, SAGGED)[0] * 1e3
    without = "sags without model term"
    return [
        Comparison(f"shoulder {without}, Salisbury", predicted[0], fallen[0], "mrad", 0.01),
        Comparison(f"elbow {without}, Salisbury", predicted[1], fallen[1], "mrad", 0.01),
        near_zero("gravity error with the model term, Salisbury", left, "µrad", 1.0),
        Comparison(f"shoulder {without}, joint PD", pd, held, "mrad", 0.01),
    ]


def draw(context: Context, soft: Log, stiff: Log) -> None:
    names = [f"Salisbury,\n{K[0, 0]:g} N/m at the tip", f"joint PD,\n{STIFF:g} N m/rad"]
    with_term = f"{names[0]},\nwith gravity term"
    with context.picture(TITLE, columns=2, size=(12.0, 5.0)) as (left, right):
        pushed = [rest(log, PUSHED) - rest(log, HELD) for log in (soft, stiff)]
        bars(left, names, [yields()[0], TORQUE / STIFF], pushed)
        left.set_title("Pushed with 2 N m at the shoulder")
        fallen = [rest(soft, SAGGED), rest(soft, HELD), rest(stiff, SAGGED)]
        formula = [sag()[0], 0.0, arm.weight(Q_D)[0] / STIFF]
        bars(right, [names[0], with_term, names[1]], formula, fallen, [BLUE, GREEN, ORANGE])
        right.set_title("Under its own weight")
        left.legend(loc="upper right")


def bars(
    ax: Axes,
    names: list[str],
    formula: list[float],
    measured: list[np.ndarray],
    colors: tuple[str, ...] | list[str] = (BLUE, ORANGE),
) -> None:
    """How far off the shoulder is: bars for the formula, circles for the log."""
    heights = np.abs(formula) * 1e3
    drawn = ax.bar(names, heights, width=0.5, color=colors, alpha=0.6, label="formula")
    ax.bar_label(drawn, [f"{height:.2g} mrad" for height in heights], padding=9)
    found = [abs(off[0]) * 1e3 for off in measured]
    ax.plot(names, found, **MEASURED, color=BLACK, label="measured", clip_on=False, zorder=5)
    ax.set_ylabel("shoulder off its target (mrad)")
    ax.margins(y=0.15)
    ax.set_ylim(bottom=0)
