"""Pictures of what two joints with variable springs give the tip."""

import numpy as np

from limber_lecture.pictures import BLUE, GREEN, MEASURED, ORANGE, Axes, ellipse, name_axes

from .fit import ASKED, CASES, ELBOWS, Tips, residual


def draw_tips(tips: Tips, ax: Axes) -> None:
    for wanted, color in zip(CASES, (BLUE, ORANGE, GREEN), strict=True):
        ax.plot(*ellipse(wanted.presented()), color=color, label=f"presented, {wanted.name}")
        ax.plot(*ellipse(tips[wanted.name]["bus"])[:, ::6], **MEASURED, color=color)
    ax.plot([], [], **MEASURED, color="0.3", label="felt on the arm")
    ax.plot(*ellipse(ASKED * np.eye(2)), "--", color="0.2", lw=1.2, label="asked")
    ax.set_aspect("equal")
    ax.margins(0.05)
    ax.set_title("Tip stiffness of two joints with variable springs")
    name_axes(ax, "along x (N/m)", "along y (N/m)")
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))


def draw_residual(shares: np.ndarray, ax: Axes) -> None:
    elbows = np.linspace(0.2, 3.0, 200)
    line = [residual(np.array([0.5, elbow])) for elbow in elbows]
    ax.plot(np.degrees(elbows), 100 * np.array(line), color=BLUE, label="formula")
    ax.plot(np.degrees(ELBOWS), 100 * shares, **MEASURED, color=BLUE, label="the controller's")
    ax.set_ylim(bottom=-2)
    ax.set_title("What a diagonal joint stiffness misses")
    name_axes(ax, "angle of the elbow (°)", "share of the wish missed (%)", "best")
