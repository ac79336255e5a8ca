"""Errors over the stiffness of the law, and how stiff it may be behind a lag."""

from dataclasses import dataclass

import numpy as np

from limber_lecture import testbench as bench
from limber_lecture.context import Comparison
from limber_lecture.pictures import BLUE, GREEN, MARKS, ORANGE, Axes, name_axes, plot_marks

from . import ideal
from .law import COULOMB_NM, KAPPA, PUSH_NM, SOFT

DEFLECTION = f"torque constant {KAPPA:g}: deflection by {PUSH_NM:g} N m"
SAG = f"torque constant {KAPPA:g}: sag under gravity"
LAG = f"dry friction of {COULOMB_NM:g} N m: lag on a ramp"
NAMES = (DEFLECTION, SAG, LAG)

Found = dict[str, dict[float, float]]


def predicted(name: str, K: float, q_d: float) -> float:
    """rad."""
    if name == DEFLECTION:
        return ideal.deflection(K)
    return ideal.sag(K, q_d) if name == SAG else COULOMB_NM / K


@dataclass(frozen=True)
class Limit:
    """Largest stable stiffness, N m/rad: from the formula and found, ideal; late and on the bus."""

    name: str
    lag: float
    formula: float
    ideal: float
    late: float
    bus: float

    def checks(self) -> list[Comparison]:
        unit = "N m/rad"
        return [
            Comparison(f"{self.name}, ideal", self.formula, self.ideal, unit, 0.03),
            Comparison(f"{self.name}, bus with its delay", self.late, self.bus, unit, 0.03),
        ]


def errors(found: Found, seen: Found, ax: Axes) -> None:
    K = np.geomspace(60, 1e4, 40)
    for name, color in zip(NAMES, (BLUE, ORANGE, GREEN), strict=True):
        line = [predicted(name, k, np.pi / 2) * 1e3 for k in K]
        ax.loglog(K, line, color=color, label=name)
        at = list(found[name])
        alone, on_bus = ([ways[name][k] * 1e3 for k in at] for ways in (found, seen))
        plot_marks(ax, at, alone, on_bus, color=color)
    ax.set_title("Errors at rest and on a ramp")
    name_axes(ax, "stiffness of the law (N m/rad)", "error of the joint angle (mrad)", "lower left")


def limits(found: list[Limit], ax: Axes) -> None:
    lags = np.linspace(1e-3, 10e-3, 40)
    D = SOFT[1]
    late = [ideal.most_stiffness(D, lag, bench.CYCLE_S, 1) for lag in lags]
    ax.plot(lags * 1e3, D / lags, color=BLUE, label="damping / lag")
    ax.plot(lags * 1e3, late, "--", color=ORANGE, label="sampled at 1 kHz, a cycle late")
    at = [limit.lag * 1e3 for limit in found]
    alone, on_bus = [limit.ideal for limit in found], [limit.bus for limit in found]
    ax.plot(at, alone, **MARKS["ideal"], color=BLUE, label="found, ideal")
    ax.plot(at, on_bus, **MARKS["bus"], color=ORANGE, label="measured on the bus")
    ax.set_ylim(0, 8000)
    ax.set_title("How stiff a law with 10 N m s/rad of damping may be")
    name_axes(
        ax, "lag of the current loop (ms)", "largest stable stiffness (N m/rad)", "upper right"
    )
