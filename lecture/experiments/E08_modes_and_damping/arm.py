"""Arms that are pushed and let go: the modes they ring with, against those they were given."""

from typing import Any

import numpy as np
from scipy.linalg import eigh

from limber.model.robot import load_robot
from limber_lecture import planar2r
from limber_lecture.context import Comparison, Context
from limber_lecture.inertia import gravity_gradient, joint_inertia, tip_inertia
from limber_lecture.pictures import BLUE, GREEN, MEASURED, ORANGE, Axes, level, name_axes
from limber_lecture.ringdown import DELAY_S, Mode, modes_of, modes_seen
from limber_lecture.timeline import in_turn, tip_gains
from limber_lecture.truth import joints, motion, status

ZETA = 0.12
FIRST_S, PUSH_S, RING_S = 2.0, 1.0, 2.5  # one push after the other, each let go at once
EVERY = 5  # samples of the log: the torques on their way have died out by then
PLANAR, SEVEN = "two joints", "seven joints"
STIFFNESS = {PLANAR: np.array([200.0, 100.0]), SEVEN: np.array([200.0] * 3 + [4.0] * 3)}
HOME = np.array([0.5, 1.0])  # where the planar arm starts
D_NULL = 3.0  # N m s/rad
NULL_SPACE = {"K_null_Nm_per_rad": 0.0, "D_null_Nms_per_rad": D_NULL}
PUSH_M, PUSH_RAD = 4e-3, 8e-3  # how far a push moves the tip


def rung(
    context: Context,
    name: str,
    robot: str,
    gains: dict[str, Any],
    wrenches: list[np.ndarray],
    modes: int,
    **head: Any,
) -> tuple[np.ndarray, list[Mode]]:
    """Pushed by each wrench and let go: the pose at rest, and the modes of the free motions."""
    cycle_s = PUSH_S + RING_S
    end = FIRST_S + len(wrenches) * cycle_s
    pushes = [{"force_N": wrench[:3], "torque_Nm": wrench[3:]} for wrench in wrenches]
    entries = in_turn(FIRST_S, cycle_s, pushes, for_s=PUSH_S)
    log = context.run_law(name, robot, gains, entries, end, **head)
    status(log, FIRST_S, end)
    tracks = []
    for push in entries:
        free = push["at_s"] + PUSH_S
        rows = motion(log, free + 0.01, free + RING_S)[::EVERY]
        tracks.append(np.hstack([joints(rows), joints(rows, "v")]))
    rest = joints(motion(log, FIRST_S - 0.1, FIRST_S))[-1]
    return rest, modes_seen(tracks, EVERY * 1e-3, modes)


def cartesian(context: Context, arm: str) -> tuple[list[Mode], list[Mode]]:
    """Modes asked for, with what the delay of the loop takes; and modes seen."""
    K = STIFFNESS[arm]
    robot, name = (planar2r.ROBOT, "planar") if arm == PLANAR else ("ideal7", "seven")
    stiffness = np.pad(K, (0, 6 - len(K)))
    damping = given_damping() if arm == PLANAR else {"damping_ratio": ZETA, **NULL_SPACE}
    gains = tip_gains(stiffness[:3], stiffness[3:], model_compensation="gravity", **damping)
    deflections = np.diag([PUSH_M] * 3 + [PUSH_RAD] * 3)[: len(K)]
    q, seen = rung(context, name, robot, gains, list(deflections * stiffness), len(K))
    return modes_asked(robot, q, np.diag(K)), seen


def modes_asked(robot: str, q: np.ndarray, K: np.ndarray) -> list[Mode]:
    """Of the joints' M s² + D s + JᵀKJ, where delay takes from D what it takes of all that depends
    on position: of the spring, and of the compensation of gravity with ∂g/∂q. The damping of the
    null space does not reach the tip, but what comes late moves both.
    """
    J, M = load_robot(robot).chain.jacobian(q)[: len(K)], joint_inertia(robot, q)
    L = tip_inertia(J, M)
    null = np.eye(len(q)) - J.T @ L @ np.linalg.solve(M, J.T).T
    D = J.T @ designed(L, K) @ J + D_NULL * null
    late = J.T @ K @ J - gravity_gradient(robot, q)
    return modes_of(M, D - DELAY_S * late, J.T @ K @ J, len(K))


def designed(L: np.ndarray, K: np.ndarray) -> np.ndarray:
    """The damping that gives every mode of Λ and K the ratio ZETA (double diagonalization)."""
    k, modes = eigh(K, L)
    return 2 * ZETA * L @ modes @ np.diag(np.sqrt(k)) @ modes.T @ L


def given_damping() -> dict[str, Any]:
    """Designed here: the controller's own design adds a floor where there is no stiffness, and a
    hand that is free to turn would feel it.
    """
    J, M = planar2r.jacobian(HOME), planar2r.inertia(HOME)
    D = np.zeros((6, 6))
    D[:2, :2] = designed(tip_inertia(J, M), np.diag(STIFFNESS[PLANAR]))
    return {"damping": "given", "D_x": D}


def checks(found: dict[str, tuple[list[Mode], list[Mode]]]) -> list[Comparison]:
    made = []
    for arm, (asked, seen) in found.items():
        for i, (a, s) in enumerate(zip(asked, seen, strict=True), 1):
            made.append(Comparison(f"{arm}, mode {i}: frequency", a.omega, s.omega, "rad/s", 0.01))
            made.append(Comparison(f"{arm}, mode {i}: damping ratio", a.zeta, s.zeta, "", 0.06))
    return made


def draw(found: dict[str, tuple[list[Mode], list[Mode]]], ax: Axes) -> None:
    for (arm, (asked, seen)), color in zip(found.items(), (ORANGE, BLUE), strict=True):
        ax.plot([m.omega for m in seen], [m.zeta for m in seen], **MEASURED, color=color, label=arm)
        for a in asked:
            ax.plot([a.omega], [a.zeta], "+", ms=11, color=color)
    ax.plot([], [], "+", ms=11, color="0.3", label="predicted")
    some = np.linspace(0, 1.1 * max(m.omega for m in found[SEVEN][0]), 20)
    level(ax, "asked for", (some[-1], ZETA), ha="right", va="bottom")
    ax.plot(some, ZETA - some * DELAY_S / 2, color=GREEN, label="less ω t/2: 1.5 ms of delay")
    ax.set_ylim(0, 0.16)
    ax.set_title("Arms let go: how their tips ring")
    name_axes(ax, "frequency of a mode (rad/s)", "damping ratio", "lower left")
