"""The demo in one picture: pushes and ways, the stiffness, the wall, the torques behind it."""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from limber.charts import time_s
from limber.logs import Log
from limber.plot_png import COLORS, STYLE
from limber.pushes import BEFORE_S, Measured
from limber.scenario import Scenario

TERMS = {
    "stiffness": "spring",
    "damping": "damper",
    "null": "posture",
    "gravity": "gravity",
    "coriolis": "Coriolis",
}
AXIS_COLORS = {"x": COLORS[1], "y": COLORS[2], "z": COLORS[0]}


def save(log: Log, scenario: Scenario, pushes: list[Measured], path: Path) -> None:
    truth, status = log.read("SIM_TRUTH"), log.read("CONTROLLER_STATUS")
    linear = [measured for measured in pushes if not measured.angular]
    with plt.rc_context(STYLE):
        fig = plt.figure(figsize=(13, 10), layout="constrained")
        grid = fig.add_gridspec(3, 3)
        _moved(fig.add_subplot(grid[0, :2]), truth, linear)
        _softness(fig.add_subplot(grid[0, 2]), linear)
        _forces(fig.add_subplot(grid[1, :]), truth, scenario)
        _torques(fig.add_subplot(grid[2, :]), status, scenario)
        friction = "with" if scenario.friction else "without"
        fig.suptitle(
            f"{scenario.robot.name}: how soft is the arm? ({friction} joint friction)", fontsize=13
        )
        fig.savefig(path, dpi=120)
    plt.close(fig)


def _letter(measured: Measured) -> str:
    return measured.axis.lstrip("+-")


def _color(measured: Measured) -> str:
    return AXIS_COLORS.get(_letter(measured), "#444444")


def _moved(ax: plt.Axes, truth: np.ndarray, pushes: list[Measured]) -> None:
    """The tip along each push, and where the asked stiffness would put it."""
    t = time_s(truth)
    for i, measured in enumerate(pushes):
        start, length = measured.push.at_s, measured.push.duration_s
        window = (t >= start - BEFORE_S) & (t <= start + length + 0.5)
        rest = truth["p_BT"][(t >= start - BEFORE_S) & (t < start)].mean(axis=0)
        sign = np.sign(measured.direction[np.argmax(np.abs(measured.direction))])
        moved_mm = (truth["p_BT"][window] - rest) @ measured.direction[:3] * 1e3 * sign
        ax.plot(t[window], moved_mm, color=_color(measured))
        asked = sign * measured.force / measured.asked * 1e3
        hidden = measured.friction_force / measured.asked * 1e3
        plateau = [start + measured.push.ramp_s, start + length - measured.push.ramp_s]
        label = "where the asked stiffness puts it" if i == 0 else None
        ax.plot(plateau, [asked] * 2, "k--", lw=1.2, label=label)
        if hidden:
            label = "what joint friction may hide" if i == 0 else None
            band = (asked - hidden, asked + hidden)
            ax.fill_between(plateau, *band, color="0.85", zorder=0, label=label)
        above = sign > 0
        tops = [*moved_mm, asked + hidden, asked - hidden]
        place = (start + length / 2, max(tops) if above else min(tops))
        ax.annotate(
            f"{measured.force:.0f} N\nalong {measured.axis}",
            place,
            xytext=(0, 8 if above else -8),
            textcoords="offset points",
            ha="center",
            va="bottom" if above else "top",
            color=_color(measured),
            fontsize=8,
        )
    ax.margins(y=0.25)
    ax.set_title("The tip gives way when pushed", loc="left")
    ax.set_ylabel("tip moved along the push's axis (mm)")
    ax.set_xlabel("arm time (s)")
    if pushes:
        ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, fontsize=8)


def _softness(ax: plt.Axes, pushes: list[Measured]) -> None:
    """Force over displacement, one point a push; the lines are the asked stiffness."""
    reach = max((abs(measured.force / measured.asked) for measured in pushes), default=0.0) * 1.25
    seen: set[str] = set()
    for measured in pushes:
        letter, color = _letter(measured), _color(measured)
        d = float(measured.displacement @ measured.direction)
        if letter not in seen:
            seen.add(letter)
            line = np.array([0.0, reach])
            ax.plot(line * 1e3, line * measured.asked, "--", color=color, lw=1.0)
            if measured.friction_force:
                low, high = (line * measured.asked + s * measured.friction_force for s in (-1, 1))
                ax.fill_between(line * 1e3, low, high, color=color, alpha=0.10, lw=0)
            label = f"{letter}: asked {measured.asked:.0f}, measured {measured.stiffness:.0f} N/m"
            ax.plot(d * 1e3, measured.force, "o", color=color, label=label)
        else:
            ax.plot(d * 1e3, measured.force, "o", color=color)
    ax.set_title("Force over distance is stiffness", loc="left")
    ax.set_xlabel("tip moved (mm)")
    ax.set_ylabel("push (N)")
    ax.set_xlim(left=0)
    ax.set_ylim(bottom=0)
    if pushes:
        ax.legend(loc="lower right", fontsize=8)


def _forces(ax: plt.Axes, truth: np.ndarray, scenario: Scenario) -> None:
    t = time_s(truth)
    push = np.linalg.norm(truth["F_push"][:, :3], axis=1)
    contact = np.linalg.norm(truth["F_contact"][:, :3], axis=1)
    ax.fill_between(t, push, color="0.8", lw=0, label="pushes")
    ax.plot(t, contact, color=COLORS[3], label="wall on the arm")
    if contact.any():
        peak = int(contact.argmax())
        ax.annotate(
            f"peak {contact[peak]:.1f} N",
            (t[peak], contact[peak]),
            xytext=(-8, 0),
            textcoords="offset points",
            ha="right",
            va="center",
            color=COLORS[3],
        )
    for wall in scenario.walls:
        ax.axvline(wall.at_s, color="0.5", ls=":", lw=1)
    title = "Forces on the arm" if not contact.any() else "Forces on the arm: pushes, then a wall"
    ax.set_title(title, loc="left")
    ax.set_ylabel("force (N)")
    ax.set_xlabel("arm time (s)")
    ax.margins(x=0, y=0.15)
    ax.legend(loc="upper left", fontsize=8)


def _torques(ax: plt.Axes, status: np.ndarray, scenario: Scenario) -> None:
    """The terms at the joint whose spring torque moves most."""
    t = time_s(status)
    count = len(scenario.robot.joints)
    spring = status["tau_stiffness"][:, :count]
    joint = int(np.ptp(spring, axis=0).argmax()) if len(status) else 0
    for i, (term, name) in enumerate(TERMS.items()):
        values = status[f"tau_{term}"][:, joint]
        if np.abs(values).max(initial=0.0) > 1e-3:
            ax.plot(t, values, label=name, color=COLORS[i])
    ax.plot(t, status["tau_sent"][:, joint], "k", lw=0.8, label="sum, as sent")
    name = scenario.robot.joints[joint].name
    ax.set_title(f"Which part of the law does it: torque of {name}, term by term", loc="left")
    ax.set_ylabel("torque (N m)")
    ax.set_xlabel("arm time (s)")
    ax.legend(loc="upper left", fontsize=8, ncols=6)
    ax.margins(x=0, y=0.2)
