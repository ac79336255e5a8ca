"""The largest inertia ratio over the loop's rate; and what a ratio does for the law outside."""

from dataclasses import dataclass

import numpy as np

from limber_lecture.context import Comparison, ideal_and_bus
from limber_lecture.pictures import BLUE, GREEN, ORANGE, Axes, name_axes, plot_marks

from . import ideal


@dataclass(frozen=True)
class Limit:
    rate: float  # Hz
    samples: int  # of delay besides the hold
    ideal: float
    bus: float

    def checks(self) -> list[Comparison]:
        delay = "a sample of delay" if self.samples else "no delay"
        name = f"largest inertia ratio, less 1, at {self.rate * 1e-3:g} kHz, {delay}"
        bound = ideal.most_ratio(self.rate, self.samples) - 1
        return ideal_and_bus(name, bound, self.ideal - 1, self.bus - 1, "", 0.05)


@dataclass(frozen=True)
class Effect:
    """Each: share of the torque that arrives, friction left over friction, push over bias."""

    rho: float
    ideal: tuple[float, float, float]
    bus: tuple[float, float, float]


def limits(found: list[Limit], ax: Axes) -> None:
    rates = np.geomspace(0.8e3, 14e3, 40)
    for samples, color, name in ((0, BLUE, "no delay"), (1, ORANGE, "a sample of delay")):
        bound = [ideal.most_ratio(rate, samples) - 1 for rate in rates]
        ax.loglog(rates * 1e-3, bound, color=color, label=f"damping / (stiffness × delay), {name}")
        mine = [limit for limit in found if limit.samples == samples]
        at = [limit.rate * 1e-3 for limit in mine]
        ideals, buses = [limit.ideal - 1 for limit in mine], [limit.bus - 1 for limit in mine]
        plot_marks(ax, at, ideals, buses, color=color)
    ax.set_title("How far the motor's inertia may be divided")
    ax.set_xticks([1, 2, 4, 10], ["1", "2", "4", "10"])
    name_axes(
        ax, "rate of the torque loop (kHz)", "largest stable inertia ratio, less 1", "upper left"
    )


def effects(found: list[Effect], kappa: float, ax: Axes) -> None:
    rho = np.linspace(1, 8.5, 60)
    lines = (
        (f"share of the torque, torque constant {kappa:g}", ideal.gained(rho, kappa), BLUE),
        ("friction that is left", 1 / rho, ORANGE),
        ("share of the sensor's bias", 1 - 1 / rho, GREEN),
    )
    for i, (name, line, color) in enumerate(lines):
        ax.plot(rho, line, color=color, label=name)
        at = [effect.rho for effect in found]
        ideals = [abs(effect.ideal[i]) for effect in found]
        buses = [abs(effect.bus[i]) for effect in found]
        plot_marks(ax, at, ideals, buses, color=color)
    ax.set_ylim(0, 1.05)
    ax.set_title("What the law outside gets")
    name_axes(ax, "inertia ratio", "share", "center right")
