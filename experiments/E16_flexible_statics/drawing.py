"""Bars: what the formula says; marks: what was found."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from limber.experiments import testbench as bench
from limber.experiments.check import Check
from limber.experiments.pictures import BLACK, BLUE, MEASURED, ORANGE

from . import arm, joint


@dataclass(frozen=True)
class Stiffness:
    """Of the link, N m/rad."""

    name: str
    predicted: float
    ideal: float
    bus: float

    def checks(self) -> list[Check]:
        name = f"stiffness of the link, {self.name}"
        return [
            Check(f"{name}, {how}", self.predicted, value, "N m/rad", 0.01)
            for how, value in (("ideal", self.ideal), ("bus", self.bus))
        ]


def _marks(at: Any, ideal: Any, bus: Any, ax: Any, named: bool) -> None:
    names = ("on the joint's equations", "measured on the bus") if named else (None, None)
    ax.plot(at, ideal, **bench.IDEAL, color=BLACK, label=names[0], zorder=4)
    ax.plot(at, bus, **MEASURED, color=BLACK, label=names[1], zorder=3)


def one_joint(found: list[Stiffness], ax: Any) -> None:
    """Deflections, so that a spring in series adds to the bar."""
    at = np.arange(len(found))
    deflections = [joint.PUSH_NM / one.predicted * 1e3 for one in found]
    ax.bar(at, deflections, 0.6, color=BLUE, alpha=0.45, label="predicted")
    ideal, bus = ([joint.PUSH_NM / k * 1e3 for k in values] for values in zip(
        *((one.ideal, one.bus) for one in found), strict=True))  # fmt: skip
    _marks(at, ideal, bus, ax, named=True)
    labels = ["on the motor,\n500", "on the motor, 500,\nconstant gravity\ntorque"]
    labels += [f"at rest of the\nlink, {K:g}" for K in joint.ASKED]
    ax.set_xticks(at, labels)
    ax.set_title(f"One joint, spring of {joint.SPRING:g} N m/rad, pushed by {joint.PUSH_NM:g} N m")
    ax.set_xlabel("law, and its stiffness (N m/rad)")
    ax.set_ylabel("deflection of the link (mrad)")
    ax.legend(loc="upper left")


def seven_joints(found: dict[str, tuple], ax: Any) -> None:
    names = {arm.ON_MOTOR: "law on the motors", arm.AT_REST: "law at rest of the links"}
    for shift, (position, color) in zip((-0.2, 0.2), ((arm.ON_MOTOR, ORANGE), (arm.AT_REST, BLUE)),
                                        strict=True):  # fmt: skip
        formula, ideal, bus = found[position]
        at = np.arange(3) + shift
        ax.bar(at, formula * 1e3, 0.36, color=color, alpha=0.45, label=names[position])
        _marks(at, ideal * 1e3, bus * 1e3, ax, named=position == arm.AT_REST)
    ax.axhline(arm.FORCE_N / arm.K_X[0, 0] * 1e3, color="0.5", ls=":", lw=1)
    ax.set_ylim(0, 17)
    ax.set_xticks(range(3), ["x", "y", "z"])
    ax.set_title(f"Seven flexible joints, {arm.FORCE_N:g} N at the tip, 3000 N/m asked for")
    ax.set_xlabel("axis of the force")
    ax.set_ylabel("tip moved along it (mm)")
    ax.legend(loc="upper left", ncols=2)
