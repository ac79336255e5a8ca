"""Salisbury's law keeps its joint damping while stiffness and inertia change with the pose."""

import numpy as np

from limber_lecture import planar2r as arm
from limber_lecture.context import Comparison, Context
from limber_lecture.pictures import BLUE, MEASURED, ORANGE, Axes, name_axes
from limber_lecture.ringdown import DELAY_S, Mode, modes_of
from limber_lecture.timeline import joint_damping, tip_gains

from .arm import rung

K = 200.0 * np.eye(2)  # N/m
D_Q = np.array([2.5, 0.5])  # N m s/rad
SHOULDER = 0.3
ELBOWS = (0.7, 1.2, 1.7, 2.2)

Found = dict[float, tuple[list[Mode], list[Mode]]]


def predicted(elbow: float) -> list[Mode]:
    q = np.array([SHOULDER, elbow])
    K_q = arm.jacobian(q).T @ K @ arm.jacobian(q)
    return modes_of(arm.inertia(q), np.diag(D_Q) - DELAY_S * K_q, K_q, 2)


def runs(context: Context) -> Found:
    found = {}
    for elbow in ELBOWS:
        gains = tip_gains([*np.diag(K), 0.0], law="salisbury", **joint_damping(D_Q))
        pushes, start = [0.4 * axis for axis in np.eye(6)[:2]], [SHOULDER, elbow]
        name = f"salisbury_{elbow:g}"
        _, seen = rung(context, name, arm.ROBOT, gains, pushes, 2, start_q=start)
        found[elbow] = predicted(elbow), seen
    return found


def checks(found: Found) -> list[Comparison]:
    made = []
    for elbow, (asked, seen) in found.items():
        for i, (a, s) in enumerate(zip(asked, seen, strict=True), 1):
            name = f"constant joint damping, elbow at {elbow:g} rad, mode {i}: damping ratio"
            made.append(Comparison(name, a.zeta, s.zeta, "", 0.06))
    ratios = [[m.zeta for m in modes] for pair in found.values() for modes in pair]
    asked, seen = (np.concatenate(ratios[i::2]) for i in (0, 1))
    name = "constant joint damping: greatest ratio over lowest"
    return [*made, Comparison(name, asked.max() / asked.min(), seen.max() / seen.min(), "", 0.06)]


def draw(found: Found, ax: Axes) -> None:
    elbows = np.linspace(0.5, 2.6, 60)
    lines = np.array([[mode.zeta for mode in predicted(elbow)] for elbow in elbows])
    for i, (name, color) in enumerate((("slow mode", BLUE), ("fast mode", ORANGE))):
        ax.plot(elbows, lines[:, i], color=color, label=name)
        ax.plot(ELBOWS, [seen[i].zeta for _, seen in found.values()], **MEASURED, color=color)
    ax.plot([], [], **MEASURED, color="0.3", label="measured")
    ax.set_ylim(bottom=0)
    ax.set_title("Salisbury's law: one joint damping, many ratios")
    name_axes(ax, "angle of the elbow (rad)", "damping ratio", "best")
