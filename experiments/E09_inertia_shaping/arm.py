"""Another inertia at the tip of planar2r: how it rings, and how a push sets it off."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from limber.experiments import planar2r
from limber.experiments.check import Check
from limber.experiments.context import Context
from limber.experiments.inertia import tip_inertia
from limber.experiments.pictures import BLUE, GREEN, MEASURED, ORANGE
from limber.experiments.ringdown import DELAY_S, Mode, modes_seen
from limber.experiments.truth import joints, motion, seconds, status
from limber.experiments.variants import TIP_SENSOR, variant

M_D = np.diag([3.0, 1.0])  # kg, wanted
K, D = 200.0, 4.0  # N/m, N s/m
M_ADDED = np.diag([3.0, 1.0])  # kg
FILTER_S = 5e-3
PUSH_S, LET_GO_S, END_S = 5.0, 7.0, 10.0
SOFT = 20.0  # N/m: hardly felt while a push begins
FORCE = np.array([3.0, 2.0])  # N
BEGIN_S = 0.1  # of the push: the arm has hardly moved yet
# Where the beginning is judged: what is fed back has come through (six time constants of its
# filter), spring and damper have not
WINDOWS_S = {
    "cartesian_impedance": (0.0, 0.02),
    "accel_feedback": (0.03, 0.1),
    "opspace_impedance": (0.005, 0.025),
}
# Lying, so that no gravity has to be compensated: that, too, would come late and change the damping
CHANGES = {"tip_sensor": {**TIP_SENSOR, "bus": "arm"}, "gravity_m_per_s2": [0.0, 0.0, -9.81]}
LAWS = {
    "cartesian_impedance": "as it is: Λ",
    "accel_feedback": "acceleration fed back: Λ + M_x",
    "opspace_impedance": "force fed back: M_d",
}


def six(M: np.ndarray) -> list[list[float]]:
    """In the first rows of a 6 x 6 matrix."""
    return np.pad(M, (0, 6 - len(M))).tolist()


def scenario(robot: str, gains: dict[str, Any], push: dict[str, Any], end_s: float) -> dict:
    gains = {"K_x_rotation_Nm_per_rad": 0.0, "damping": "given", **gains}
    return {
        "robot": robot,
        "integrator": "reference",
        "duration_s": end_s + 0.1,
        "timeline": [
            {"at_s": 0.3, "mode": "hold"},
            {"at_s": 0.8, "mode": "active"},
            {"at_s": 1.0, "gains": gains},
            {"at_s": PUSH_S, "push": push},
        ],
    }


def shaped_modes(context: Context, robot: str, contact: str) -> list[Mode]:
    """The tip pushed aside and let go; modes of its motion."""
    gains = {
        "law": "opspace_impedance",
        "K_x_translation_N_per_m": [K, K, 0.0],
        "M_x": six(M_D),
        "D_x": six(D * np.eye(2)),
        "contact": contact,
    }
    push = {"force_N": [4.0, 4.0, 0.0], "ramp_s": 0.1, "for_s": LET_GO_S - PUSH_S}
    log = context.lab(scenario(robot, gains, push, END_S), f"ring_{contact}")
    status(log, PUSH_S, END_S)
    rows = motion(log, LET_GO_S + 0.01, END_S)[::5]
    return modes_seen([np.hstack([rows["p_BT"][:, :2], rows["V_BT"][:, :2]])], 5e-3, 2)


def asked_modes() -> list[Mode]:
    """√(K/M) and D/(2√(K M)), D less what the delay of the loop takes."""
    found = []
    for m in np.diag(M_D):
        omega = np.sqrt(K / m)
        found.append(Mode(float(omega), float((D - K * DELAY_S) / (2 * m * omega))))
    return found


def wanted_inertia(law: str, q: np.ndarray) -> np.ndarray:
    L = tip_inertia(planar2r.jacobian(q), planar2r.inertia(q))
    return {
        "cartesian_impedance": L,
        "accel_feedback": L + M_ADDED,
        "opspace_impedance": M_D,
    }[law]


@dataclass(frozen=True)
class Start:
    """How the tip sets off under FORCE: velocity over time, and accelerations at the beginning."""

    t: np.ndarray
    V: np.ndarray
    predicted: np.ndarray
    measured: np.ndarray


def pushed(context: Context, robot: str, law: str) -> Start:
    gains = {
        "law": law,
        "K_x_translation_N_per_m": [SOFT, SOFT, 0.0],
        "D_x": six(D * np.eye(2)),
        "contact": "tip_sensor" if law == "opspace_impedance" else "none",
        "M_x": six(M_D if law == "opspace_impedance" else M_ADDED),
        "acceleration_filter_s": FILTER_S,
    }
    push = {"force_N": [*FORCE.tolist(), 0.0], "for_s": BEGIN_S}
    end = PUSH_S + BEGIN_S
    log = context.lab(scenario(robot, gains, push, end), f"push_{law}")
    status(log, PUSH_S - 0.1, end)
    rows = motion(log, PUSH_S - 0.01, end)
    first = np.flatnonzero(np.abs(rows["F_push"]).max(axis=1) > 0)[0] - 1
    rest = joints(rows)[first]
    t = (seconds(rows) - seconds(rows)[first])[first:]
    V = rows["V_BT"][first:, :2]
    since, until = WINDOWS_S[law]
    judged = (t > since - 1e-6) & (t < until)
    measured = np.polyfit(t[judged], V[judged], 3)[2]
    return Start(t, V, np.linalg.solve(wanted_inertia(law, rest), FORCE), measured)


def runs(context: Context) -> tuple[dict[str, list[Mode]], dict[str, Start]]:
    robot = variant(context.out, planar2r.ROBOT, CHANGES)
    modes = {name: shaped_modes(context, robot, name) for name in ("tip_sensor", "joint_torque")}
    return modes, {law: pushed(context, robot, law) for law in LAWS}


def checks(modes: dict[str, list[Mode]], starts: dict[str, Start]) -> list[Check]:
    found = []
    for source, seen in modes.items():
        for axis, asked, mode in zip("xy", asked_modes(), seen, strict=True):
            name = f"inertia shaped, {source.replace('_', ' ')}, along {axis}"
            found.append(Check(f"{name}: frequency", asked.omega, mode.omega, "rad/s", 0.01))
            found.append(Check(f"{name}: damping ratio", asked.zeta, mode.zeta, "", 0.05))
    for law, start in starts.items():
        for i, axis in enumerate("xy"):
            name = f"acceleration at the start of a push, {law}, along {axis}"
            values = float(start.predicted[i]), float(start.measured[i])
            found.append(Check(name, *values, "m/s²", 0.02))
    return found


def draw(starts: dict[str, Start], ax: Any) -> None:
    colors = (BLUE, ORANGE, GREEN)
    for (law, start), color in zip(starts.items(), colors, strict=True):
        ms = start.t * 1e3
        ax.plot(ms, start.predicted[0] * start.t * 1e3, color=color, label=LAWS[law])
        ax.plot(ms[:51:3], start.V[:51:3, 0] * 1e3, **MEASURED, color=color)
    ax.plot([], [], **MEASURED, color="0.3", label="measured; line: inertia⁻¹ force")
    ax.set_title("A push of 3 N begins: how fast the tip sets off")
    ax.set_xlabel("time since the push began (ms)")
    ax.set_ylabel("speed of the tip along x (mm/s)")
    ax.annotate("here the damper begins to act", (42, 148), xytext=(50, 72), ha="right",
                arrowprops={"arrowstyle": "->"})  # fmt: skip
    ax.set_xlim(-1, 51)
    ax.set_ylim(0, 200)
    ax.legend(loc="upper left")
