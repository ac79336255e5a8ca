"""Another inertia at the tip of planar2r: how it rings, and how a push sets it off."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from limber_lecture import planar2r
from limber_lecture.context import Comparison, Context
from limber_lecture.inertia import tip_inertia
from limber_lecture.pictures import ARROW, BLUE, GREEN, MEASURED, ORANGE, Axes, name_axes
from limber_lecture.ringdown import DELAY_S, Mode, modes_seen
from limber_lecture.timeline import tip_gains
from limber_lecture.truth import Log, joints, motion, status, time_s
from limber_lecture.variants import TIP_SENSOR, variant

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


def six(M: np.ndarray) -> np.ndarray:
    """In the first rows of a 6 x 6 matrix."""
    return np.pad(M, (0, 6 - len(M)))


def shaped_modes(context: Context, robot: str, contact: str) -> list[Mode]:
    """The tip pushed aside and let go; modes of its motion."""
    shaping = {"law": "opspace_impedance", "M_x": six(M_D), "contact": contact}
    push = {"force_N": [4.0, 4.0, 0.0], "ramp_s": 0.1, "for_s": LET_GO_S - PUSH_S}
    log = run(context, f"ring_{contact}", robot, K, shaping, push, END_S)
    status(log, PUSH_S, END_S)
    rows = motion(log, LET_GO_S + 0.01, END_S)[::5]
    return modes_seen([np.hstack([rows["p_BT"][:, :2], rows["V_BT"][:, :2]])], 5e-3, 2)


def run(
    context: Context,
    name: str,
    robot: str,
    stiffness: float,
    shaping: dict[str, Any],
    push: dict[str, Any],
    end_s: float,
) -> Log:
    """A push on the tip, which is on a soft spring in the plane and has a damper."""
    gains = tip_gains([stiffness, stiffness, 0.0], damping="given", D_x=six(D * np.eye(2)))
    entries = [{"at_s": PUSH_S, "push": push}]
    return context.run_law(name, robot, {**gains, **shaping}, entries, end_s)


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
    senses = law == "opspace_impedance"
    shaping = {
        "law": law,
        "contact": "tip_sensor" if senses else "none",
        "M_x": six(M_D if senses else M_ADDED),
        "acceleration_filter_s": FILTER_S,
    }
    end = PUSH_S + BEGIN_S
    push = {"force_N": [*FORCE, 0.0], "for_s": BEGIN_S}
    log = run(context, f"push_{law}", robot, SOFT, shaping, push, end)
    status(log, PUSH_S - 0.1, end)
    rows = motion(log, PUSH_S - 0.01, end)
    first = np.flatnonzero(np.abs(rows["F_push"]).max(axis=1) > 0)[0] - 1
    rest = joints(rows)[first]
    t = (time_s(rows) - time_s(rows)[first])[first:]
    V = rows["V_BT"][first:, :2]
    since, until = WINDOWS_S[law]
    judged = (t > since - 1e-6) & (t < until)
    measured = np.polyfit(t[judged], V[judged], 3)[2]
    return Start(t, V, np.linalg.solve(wanted_inertia(law, rest), FORCE), measured)


def runs(context: Context) -> tuple[dict[str, list[Mode]], dict[str, Start]]:
    robot = variant(context.out, planar2r.ROBOT, CHANGES)
    modes = {name: shaped_modes(context, robot, name) for name in ("tip_sensor", "joint_torque")}
    return modes, {law: pushed(context, robot, law) for law in LAWS}


def checks(modes: dict[str, list[Mode]], starts: dict[str, Start]) -> list[Comparison]:
    found = []
    for source, seen in modes.items():
        for axis, asked, mode in zip("xy", asked_modes(), seen, strict=True):
            name = f"inertia shaped, {source.replace('_', ' ')}, along {axis}"
            found.append(Comparison(f"{name}: frequency", asked.omega, mode.omega, "rad/s", 0.01))
            found.append(Comparison(f"{name}: damping ratio", asked.zeta, mode.zeta, "", 0.05))
    for law, start in starts.items():
        for i, axis in enumerate("xy"):
            name = f"acceleration at the start of a push, {law}, along {axis}"
            found.append(Comparison(name, start.predicted[i], start.measured[i], "m/s²", 0.02))
    return found


def draw(starts: dict[str, Start], ax: Axes) -> None:
    colors = (BLUE, ORANGE, GREEN)
    for (law, start), color in zip(starts.items(), colors, strict=True):
        ms = start.t * 1e3
        ax.plot(ms, start.predicted[0] * start.t * 1e3, color=color, label=LAWS[law])
        ax.plot(ms[:51:3], start.V[:51:3, 0] * 1e3, **MEASURED, color=color)
    ax.plot([], [], **MEASURED, color="0.3", label="measured; line: inertia⁻¹ force")
    ax.set_title("A push of 3 N begins: how fast the tip sets off")
    ax.annotate("here the damper begins to act", (42, 148), (50, 72), ha="right", **ARROW)
    ax.set_xlim(-1, 51)
    ax.set_ylim(0, 200)
    name_axes(ax, "time since the push began (ms)", "speed of the tip along x (mm/s)", "upper left")
