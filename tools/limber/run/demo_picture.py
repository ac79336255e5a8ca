"""The demo in one picture: pushes, displacements, stiffness, contact with the wall, torques."""

from functools import partial
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from limber.log.reader import Log, time_s
from limber.measure.pushes import BEFORE_S, MeasuredPush
from limber.model.scenario import Scenario
from limber.plot import stick_figure
from limber.plot.charts import TERMS
from limber.plot.style import COLORS, STYLE, name_axes, note

DITHER_S = 0.2  # five periods
AXIS_COLORS = dict(zip("xyz", COLORS, strict=False))


def save(log: Log, scenario: Scenario, pushes: list[MeasuredPush], path: Path) -> None:
    truth, status = log.read("SIM_TRUTH"), log.read("CONTROLLER_STATUS")
    linear = [measured for measured in pushes if not measured.angular]
    with plt.rc_context(STYLE):
        fig = plt.figure(figsize=(13, 10), layout="constrained")
        grid = fig.add_gridspec(3, 3)
        _moved(fig.add_subplot(grid[0, :2]), truth, linear)
        _softness(fig.add_subplot(grid[0, 2]), linear)
        _forces(fig.add_subplot(grid[1, :2]), truth, scenario)
        _arm(fig.add_subplot(grid[1, 2]), scenario, linear)
        _torques(fig.add_subplot(grid[2, :]), status, scenario)
        friction = "with" if scenario.friction else "without"
        fig.suptitle(
            f"{scenario.robot.name}: how soft is the arm? ({friction} joint friction)", fontsize=13
        )
        fig.savefig(path, dpi=120)
    plt.close(fig)


def _color(measured: MeasuredPush) -> str:
    return AXIS_COLORS.get(measured.axis.lstrip("+-"), "#444444")


def _moved(ax: plt.Axes, truth: np.ndarray, pushes: list[MeasuredPush]) -> None:
    """The tip along each push, and where the expected stiffness would put it."""
    t = time_s(truth)
    for i, measured in enumerate(pushes):
        start, length = measured.push.at_s, measured.push.duration_s
        window = (t >= start - BEFORE_S) & (t <= start + length + 0.5)
        rest = truth["p_BT"][(t >= start - BEFORE_S) & (t < start)].mean(axis=0)
        sign = np.sign(measured.direction[np.argmax(np.abs(measured.direction))])
        moved_mm = (truth["p_BT"][window] - rest) @ measured.direction[:3] * 1e3 * sign
        ax.plot(t[window], moved_mm, color=_color(measured))
        plateau = [start + measured.push.ramp_s, start + length - measured.push.ramp_s]
        mm_per_N = sign * 1e3 / measured.expected
        expected = measured.force * mm_per_N
        left = (measured.force - measured.friction_took) * mm_per_N
        labels = ("expected: force / stiffness", "expected, less what friction took")
        ax.plot(plateau, [expected] * 2, "k--", lw=1.2, label=None if i else labels[0])
        if measured.friction_bound:
            ax.plot(plateau, [left] * 2, "k:", lw=1.6, label=None if i else labels[1])
        tops = [*moved_mm, expected]
        note(
            ax,
            f"{measured.force:.0f} N\nalong {measured.axis}" + "\ndither" * measured.dithered,
            (start + length / 2, max(tops) if sign > 0 else min(tops)),
            (0, 6 * sign),
            ha="center",
            va="bottom" if sign > 0 else "top",
            color=_color(measured),
            fontsize=8,
        )
    ax.margins(y=0.35)
    ax.set_title("The tip gives way when pushed", loc="left")
    name_axes(ax, "arm time (s)", "tip moved along the push's axis (mm)")
    if pushes:
        ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, fontsize=8)


def _softness(ax: plt.Axes, pushes: list[MeasuredPush]) -> None:
    """Force over distance: as felt, and after friction has taken its part; the line is expected."""
    reach_mm = max((measured.force / measured.expected for measured in pushes), default=0.0) * 1250
    for expected in sorted({round(measured.expected) for measured in pushes}):
        ax.plot([0, reach_mm], [0, expected * reach_mm * 1e-3], "k--", lw=1.0)
        place = (reach_mm * 0.97, expected * reach_mm * 0.97e-3)
        ax.annotate(f"expected: {expected} N/m", place, ha="right", va="bottom", fontsize=8)
    for measured in pushes:
        d_mm, left = measured.moved * 1e3, measured.force - measured.friction_took
        color = _color(measured)
        value = measured.stiffness_without_friction
        label = f"{measured.axis}: {value:.0f} N/m"
        if measured.friction_bound:
            label += f" less friction, felt {measured.stiffness:.0f}"
            label += ", dither" * measured.dithered
            ax.plot(d_mm, measured.force, "o", color=color, mfc="white")
            ax.plot([d_mm] * 2, [measured.force, left], ":", color=color, lw=1.5)
        ax.plot(d_mm, left, "o", color=color, label=label)
    ax.set_title("Force over distance is stiffness", loc="left")
    name_axes(ax, "tip moved (mm)", "push (N)")
    ax.set(xlim=(0, None), ylim=(0, None))
    if pushes:
        ax.plot([], [], "o", color="0.4", mfc="white", label="as felt, with friction")
        ax.legend(loc="lower right", fontsize=8)


def _arm(ax: plt.Axes, scenario: Scenario, pushes: list[MeasuredPush]) -> None:
    """The arm from the side, with the pushes that lie in the picture, and the wall."""
    robot = scenario.robot
    points = stick_figure.arm_points(robot, robot.home)
    view = stick_figure.View.of(points, -robot.gravity, margin_m=0.2)
    places = view.project(points)
    ax.plot(places[:, 0], places[:, 1], "-", color="0.55", lw=5, solid_capstyle="round")
    ax.plot(places[1:-1, 0], places[1:-1, 1], "o", color="0.25", ms=6)
    tip = places[-1]
    for measured in pushes:
        along = view.project(measured.direction[:3])
        if np.linalg.norm(along) > 0.5:
            arrow = {"arrowstyle": "->", "color": _color(measured), "lw": 2}
            end = tip + 0.17 * along
            ax.annotate("", end, tip, arrowprops=arrow)
            note(ax, measured.axis, end, (4, 4), color=_color(measured), fontsize=8)
    for wall in scenario.walls:
        normal = view.project(wall.normal)
        if np.linalg.norm(normal) > 0.9:
            place, face = view.project(wall.point), np.array([-normal[1], normal[0]])
            ends = np.array([place - 0.12 * face, place + 0.12 * face])
            ax.plot(ends[:, 0], ends[:, 1], color=COLORS[3], lw=3, label="wall")
            ax.legend(loc="upper right", fontsize=8)
    ax.set(aspect="equal", xlim=(view.low[0], view.high[0]), ylim=(view.low[1], view.high[1]))
    ax.set_title("The arm from the side", loc="left")
    name_axes(ax, "along the floor (m)", "height (m)")


def _forces(ax: plt.Axes, truth: np.ndarray, scenario: Scenario) -> None:
    t = time_s(truth)
    push = np.linalg.norm(truth["F_push"][:, :3], axis=1)
    contact = np.linalg.norm(truth["F_contact"][:, :3], axis=1)
    ax.fill_between(t, push, color="0.8", lw=0, label="pushes")
    ax.plot(t, contact, color=COLORS[3], label="wall on the arm")
    if contact.any():
        peak = int(contact.argmax())
        place, style = (t[peak], contact[peak]), {"va": "center", "color": COLORS[3]}
        note(ax, f"peak {contact[peak]:.1f} N", place, (8, 0), ha="left", **style)
    for wall in scenario.walls:
        ax.axvline(wall.at_s, color="0.5", ls=":", lw=1)
        ax.annotate(" wall put up", (wall.at_s, 0), va="bottom", color="0.4", fontsize=8)
    title = "Forces on the arm" if not contact.any() else "Forces on the arm: pushes, then a wall"
    ax.set_title(title, loc="left")
    name_axes(ax, "arm time (s)", "force (N)")
    ax.margins(x=0, y=0.15)
    ax.legend(loc="upper left", fontsize=8)


def _torques(ax: plt.Axes, status: np.ndarray, scenario: Scenario) -> None:
    """The terms at the joint whose spring torque moves most. The mean of a dither's periods: the
    arm moves by that.
    """
    t = time_s(status)
    dithered = any(gains.dithered for gains in scenario.gains)
    mean = partial(_mean, t, DITHER_S) if dithered else np.asarray
    count = len(scenario.robot.joints)
    spring = status["tau_stiffness"][:, :count]
    joint = int(np.ptp(spring, axis=0).argmax()) if len(status) else 0
    for i, (term, name) in enumerate(TERMS.items()):
        values = mean(status[f"tau_{term}"][:, joint])
        if np.abs(values).max(initial=0.0) > 1e-3:
            ax.plot(t, values, label=name, color=COLORS[i])
    sent = status["tau_sent"][:, joint]
    ax.plot(t, mean(sent), "k", lw=0.8, label="sum, as sent")
    name = scenario.robot.joints[joint].name
    title = f"Which part of the law does it: torque of {name}, term by term"
    if dithered:
        swing_Nm = np.abs(sent - mean(sent))[t > t[0] + DITHER_S].max(initial=0.0)
        title += f" (means over {DITHER_S:g} s; the dither swings by {swing_Nm:.1f} N m)"
    ax.set_title(title, loc="left")
    name_axes(ax, "arm time (s)", "torque (N m)")
    ax.legend(loc="upper left", fontsize=8, ncols=6)
    ax.margins(x=0, y=0.2)


def _mean(t: np.ndarray, span_s: float, values: np.ndarray) -> np.ndarray:
    """Over the span around each time; of evenly spaced samples."""
    if len(t) < 2:
        return values
    count = max(1, round(span_s / float(np.median(np.diff(t)))))
    before = count // 2
    held = np.pad(values, (before, count - 1 - before), mode="edge")
    return np.convolve(held, np.full(count, 1 / count), mode="valid")
