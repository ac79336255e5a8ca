"""What stiffness control gives way to, and what position control does not."""

from typing import Any

import numpy as np
from scipy.optimize import fsolve

from limber.experiments import planar2r as arm
from limber.experiments.check import Check
from limber.experiments.context import Context
from limber.experiments.pictures import BLACK, BLUE, GREEN, MEASURED, ORANGE
from limber.experiments.truth import joints, motion, status
from limber.logs import Log

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


def scenario(law: dict[str, Any]) -> dict[str, Any]:
    """Gravity compensated at first, with a push in each part, and in the end not."""

    def push(rests_at: float, **wrench: Any) -> dict[str, Any]:
        return {"at_s": rests_at - 1.4, "push": {**wrench, "ramp_s": 0.2, "for_s": 1.6}}

    return {
        "robot": "planar2r",
        "duration_s": SAGGED + 0.1,
        "integrator": "reference",
        "start_q": Q_D.tolist(),
        "timeline": [
            {"at_s": 0.3, "mode": "hold"},
            {"at_s": 0.8, "mode": "active"},
            {"at_s": 1.0, "gains": {**law, "bias": "gravity"}},
            {"at_s": 1.1, "goal": {"joints_rad": Q_D.tolist(), "duration_s": 0.2}},
            # a moment on the first link turns no joint but the shoulder
            push(PUSHED, link="link1", torque_Nm=[0.0, 0.0, TORQUE]),
            push(TIP_X, force_N=[FORCE, 0.0, 0.0]),
            push(TIP_Y, force_N=[0.0, FORCE, 0.0]),
            {"at_s": 9.5, "gains": {"bias": "none"}},
        ],
    }


def run(context: Context) -> list[Check]:
    soft = context.lab(
        scenario(
            {
                "law": "salisbury",
                "K_x_translation_N_per_m": float(K[0, 0]),
                "joint_damping": "given",
                "D_q_Nms_per_rad": K_V,
            }
        ),
        "salisbury",
    )
    stiff = context.lab(
        scenario({"law": "joint_pd", "K_q_Nm_per_rad": STIFF, "joint_damping_ratio": 0.7}),
        "joint_pd",
    )
    draw(context, soft, stiff)
    return [*disturbances(soft, stiff), *tip_spring(soft), *gravity(soft, stiff)]


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


def disturbances(soft: Log, stiff: Log) -> list[Check]:
    predicted, small = yields(), TORQUE / STIFF
    measured, held = rest(soft, PUSHED) - rest(soft, HELD), rest(stiff, PUSHED) - rest(stiff, HELD)
    return [
        Check("disturbance of 2 N m, soft over stiff", predicted[0] / small,
              float(measured[0] / held[0]), "", 0.05),
        Check("shoulder gives way, Salisbury", predicted[0] * 1e3, measured[0] * 1e3, "mrad", 0.05),
        Check("elbow gives way, Salisbury", predicted[1] * 1e3, measured[1] * 1e3, "mrad", 0.05),
        Check("shoulder gives way, joint PD", small * 1e3, held[0] * 1e3, "mrad", 0.05),
        Check("elbow gives way, joint PD", 0.0, held[1] * 1e3, "mrad", 0.05 * small * 1e3,
              "absolute"),
    ]  # fmt: skip


def tip_spring(soft: Log) -> list[Check]:
    """A small force moves the tip by K⁻¹ f, and not across."""
    moved = FORCE / K[0, 0] * 1e3
    found = []
    for name, at_s, along in (("x", TIP_X, 0), ("y", TIP_Y, 1)):
        off = (arm.tip(Q_D + rest(soft, at_s)) - arm.tip(Q_D)) * 1e3
        title = f"small displacement: tip under {FORCE:g} N along {name}"
        found.append(Check(title, moved, float(off[along]), "mm", 0.01))
        found.append(
            Check(f"{title}, across", 0.0, float(off[1 - along]), "mm", 0.01 * moved, "absolute")
        )
    return found


def gravity(soft: Log, stiff: Log) -> list[Check]:
    found = []
    measured, predicted = rest(soft, SAGGED), sag()
    for i, name in enumerate(("shoulder", "elbow")):
        title = f"{name} sags without model term, Salisbury"
        found.append(Check(title, predicted[i] * 1e3, measured[i] * 1e3, "mrad", 0.01))
    title = "gravity error with the model term, Salisbury"
    left = float(np.abs(rest(soft, HELD)).max()) * 1e6
    found.append(Check(title, 0.0, left, "µrad", 1.0, "absolute"))
    held = rest(stiff, SAGGED)
    title = "shoulder sags without model term, joint PD"
    pd = -arm.weight(Q_D)[0] / STIFF
    return [*found, Check(title, pd * 1e3, held[0] * 1e3, "mrad", 0.01)]


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
    ax: Any,
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
