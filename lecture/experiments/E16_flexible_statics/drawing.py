"""Bars: what the formula says; marks: what was found."""

from dataclasses import dataclass

import numpy as np

from limber_lecture.context import Comparison, ideal_and_bus
from limber_lecture.pictures import BLACK, BLUE, ORANGE, Axes, name_axes, plot_marks

from . import arm, joint


@dataclass(frozen=True)
class Stiffness:
    """Of the link, N m/rad."""

    name: str
    predicted: float
    ideal: float
    bus: float

    def checks(self) -> list[Comparison]:
        name = f"stiffness of the link, {self.name}"
        return ideal_and_bus(name, self.predicted, self.ideal, self.bus, "N m/rad", 0.01)


def one_joint(found: list[Stiffness], ax: Axes) -> None:
    """Deflections, so that a spring in series adds to the bar."""
    at = np.arange(len(found))
    deflections = [joint.PUSH_NM / one.predicted * 1e3 for one in found]
    ax.bar(at, deflections, 0.6, color=BLUE, alpha=0.45, label="predicted")
    ideal, bus = (joint.PUSH_NM / np.array([(one.ideal, one.bus) for one in found]).T) * 1e3
    plot_marks(ax, at, ideal, bus, color=BLACK, zorder=4)
    labels = ["on the motor,\n500", "on the motor, 500,\nconstant gravity\ntorque"]
    labels += [f"at rest of the\nlink, {K:g}" for K in joint.ASKED]
    ax.set_xticks(at, labels)
    ax.set_title(f"One joint, spring of {joint.SPRING:g} N m/rad, pushed by {joint.PUSH_NM:g} N m")
    name_axes(ax, "law, and its stiffness (N m/rad)", "deflection of the link (mrad)", "upper left")


def seven_joints(found: dict[str, tuple], ax: Axes) -> None:
    names = {arm.ON_MOTOR: "law on the motors", arm.AT_REST: "law at rest of the links"}
    for shift, position, color in ((-0.2, arm.ON_MOTOR, ORANGE), (0.2, arm.AT_REST, BLUE)):
        formula, ideal, bus = (values * 1e3 for values in found[position])
        at = np.arange(3) + shift
        ax.bar(at, formula, 0.36, color=color, alpha=0.45, label=names[position])
        plot_marks(ax, at, ideal, bus, color=BLACK, zorder=4)
    ax.axhline(arm.FORCE_N / arm.K_X[0, 0] * 1e3, color="0.5", ls=":", lw=1)
    ax.set_ylim(0, 17)
    ax.set_xticks(range(3), ["x", "y", "z"])
    ax.set_title(f"Seven flexible joints, {arm.FORCE_N:g} N at the tip, 3000 N/m asked for")
    name_axes(ax, "axis of the force", "tip moved along it (mm)")
    ax.legend(loc="upper left", ncols=2)
