"""Share of runs that hold: over each parameter as bars, with Wilson's interval of 95 % (Wilson,
1927), over each pair as a map.
"""

import itertools
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pyarrow
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

from limber.arrays import Floats
from limber.log.results import written_whole
from limber.plot.style import STYLE
from limber.sweep.definition import Sweep
from limber.sweep.one_run import BEYOND, FAULT, HOLDS, OUTCOMES, REFUSED
from limber.sweep.variation import Variation, unit_of

COLORS = {HOLDS: "#0072B2", BEYOND: "#E69F00", FAULT: "#D55E00", REFUSED: "#7F7F7F"}
MARKS = {HOLDS: "o", BEYOND: "s", FAULT: "X", REFUSED: "P"}
Z = 1.96
MOST_BINS, RUNS_A_BIN = 12, 8


def draw(sweep: Sweep, rows: pyarrow.Table, path: Path) -> None:
    """Of what is varied; a list of one value is left out."""
    varied = [v for v in sweep.vary if len(v.values) != 1] or list(sweep.vary)
    axes = [_Axis(variation, rows[variation.key].to_pylist()) for variation in varied]
    outcomes = np.array(rows["outcome"].to_pylist())
    n = len(axes)
    with plt.rc_context({**STYLE, "axes.labelsize": 7.5}):
        figure, grid = plt.subplots(n, n, squeeze=False, layout="constrained")
        figure.set_size_inches(3.4 * n + 2, 2.7 * n + 1)
        for row, column in itertools.product(range(n), range(n)):
            ax = grid[row, column]
            if column > row:
                ax.axis("off")
            elif row == column:
                _bars(ax, axes[row], outcomes)
            else:
                mesh = _map(ax, axes[column], axes[row], outcomes)
            if row == n - 1:
                ax.set_xlabel(axes[column].name)
            if column == 0:
                ax.set_ylabel(axes[row].name if row else "share of runs")
        _explain(figure, sweep, outcomes)
        if n > 1:
            figure.colorbar(mesh, ax=grid, label="share that holds (maps)", shrink=0.5)
        with written_whole(path) as part:
            figure.savefig(part, dpi=130, format="png")
        plt.close(figure)


def wilson(good: Floats, of: Floats) -> tuple[Floats, Floats]:
    """The interval that holds a share with 95 %, of counts above zero."""
    share = good / of
    centre = (share + Z**2 / (2 * of)) / (1 + Z**2 / of)
    half = Z / (1 + Z**2 / of) * np.sqrt(share * (1 - share) / of + Z**2 / (4 * of**2))
    return np.maximum(centre - half, 0.0), np.minimum(centre + half, 1.0)


class _Axis:
    """Where the runs are along a parameter; a list has a place for each value."""

    def __init__(self, variation: Variation, values: list[Any]) -> None:
        unit, self._listed = unit_of(variation.key), variation.values
        self.name = f"{variation.key} ({unit})" if unit else variation.key
        self.log = variation.how == "log"
        places = [self._listed.index(value) for value in values] if self._listed else values
        self.at = np.array(places, float)
        half = 0.5 if self._listed or variation.how == "whole" else 0.0
        low, high = (0, len(self._listed) - 1) if self._listed else (variation.low, variation.high)
        self._ends = low - half, high + half

    def edges(self, most: int) -> Floats:
        low, high = self._ends
        steps = np.linspace(0, 1, (len(self._listed) or most) + 1)
        return np.asarray(low * (high / low) ** steps if self.log else low + (high - low) * steps)

    def scale(self, ax: Axes, name: str) -> None:
        """`name`: x or y."""
        ax.set(**{f"{name}scale": "log" if self.log else "linear", f"{name}lim": self._ends})
        if self.log:
            axis = ax.xaxis if name == "x" else ax.yaxis
            axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
            axis.set_major_formatter(StrMethodFormatter("{x:g}"))
            axis.set_minor_formatter(NullFormatter())
        if self._listed:
            ax.set(**{f"{name}ticks": range(len(self._listed)), f"{name}ticklabels": self._listed})


def _bars(ax: Axes, axis: _Axis, outcomes: np.ndarray) -> None:
    edges = axis.edges(int(np.clip(len(outcomes) // RUNS_A_BIN, 1, MOST_BINS)))
    there = np.histogram(axis.at, edges)[0] > 0
    of = np.histogram(axis.at, edges)[0][there].astype(float)
    left, width, below = edges[:-1][there], np.diff(edges)[there], np.zeros(len(of))
    shares = {
        name: np.histogram(axis.at[outcomes == name], edges)[0][there] / of for name in COLORS
    }
    for name, share in shares.items():
        ax.bar(left, share, width, below, align="edge", color=COLORS[name], edgecolor="w")
        below += share
    share = shares[HOLDS]
    low, high = wilson(share * of, of)
    middle = np.sqrt(left * (left + width)) if axis.log else left + width / 2
    ax.errorbar(middle, share, [share - low, high - share], fmt="none", ecolor="0.2", capsize=3)
    axis.scale(ax, "x")
    ax.set_ylim(0, 1.02)


def _map(ax: Axes, x: _Axis, y: _Axis, outcomes: np.ndarray) -> QuadMesh:
    most = int(np.clip(np.sqrt(len(outcomes) / RUNS_A_BIN), 2, MOST_BINS))
    edges = x.edges(most), y.edges(most)
    holds = outcomes == HOLDS
    runs = np.histogram2d(x.at, y.at, edges)[0]
    good = np.histogram2d(x.at[holds], y.at[holds], edges)[0]
    share = np.where(runs > 0, good / np.maximum(runs, 1), np.nan)
    mesh = ax.pcolormesh(*edges, share.T, cmap="Greens", vmin=0, vmax=1, alpha=0.45, linewidth=0)
    size = max(3.0, 24 - len(outcomes) / 30)
    for name in OUTCOMES:
        chosen = outcomes == name
        style = {"color": COLORS[name], "marker": MARKS[name], "markersize": size**0.5}
        ax.plot(x.at[chosen], y.at[chosen], linestyle="none", **style)
    x.scale(ax, "x")
    y.scale(ax, "y")
    ax.grid(False)
    return mesh


def _explain(figure: plt.Figure, sweep: Sweep, outcomes: np.ndarray) -> None:
    counts = {name: int((outcomes == name).sum()) for name in OUTCOMES}
    good, of = counts[HOLDS], len(outcomes)
    low, high = wilson(np.array(float(good)), np.array(float(of)))
    title = f"{good / of:.0%} of {of} runs hold (95 %: {low:.0%} to {high:.0%}): no fault,\n"
    title += f"stiffness within tolerance, overshoot at most {sweep.overshoot:.0%}"
    figure.suptitle(title, fontsize=9)
    lines = [Line2D([], [], color=COLORS[name], marker=MARKS[name], ls="none") for name in counts]
    words = [f"{name}: {count}" for name, count in counts.items()]
    figure.legend(lines, words, loc="outside lower center", ncols=len(counts), fontsize=8)
