"""The picture of a soak in real time: lateness of the cycles, pauses of the machine, stops."""

from pathlib import Path

import numpy as np
from matplotlib import pyplot

from limber.plot import style
from limber_qa.machine_pauses import Pause

NAMES = ("half of all cycles", "99 %", "99.9 %", "all")


def draw(rows: np.ndarray, stops: list, pauses: list[Pause], begin_s: float, path: Path) -> None:
    """Lateness of the cycles so far; below, each pause of the machine. Stops in both."""
    with pyplot.rc_context(style.STYLE):
        figure, (late, still) = pyplot.subplots(
            2, sharex=True, figsize=(7, 5), layout="constrained"
        )
        minutes = (rows[:, 0] - begin_s) / 60
        for column, (name, color) in enumerate(zip(NAMES, style.COLORS, strict=False), 1):
            late.semilogy(minutes, np.maximum(rows[:, column], 0.01), color=color, label=name)
        style.name_axes(late, "", "late by less than, µs")
        at = [(pause.start_s - begin_s) / 60 for pause in pauses]
        length_ms = [1e3 * pause.length_s for pause in pauses]
        still.semilogy(at, length_ms, ".", color="0.4", ms=2)
        style.name_axes(still, "time of the run, min", "machine stood still, ms")
        for ax in (late, still):
            for i, stop in enumerate(stops):
                label = "arm held" if i == 0 and ax is still else None
                ax.axvline(stop.at_s / 60, color=style.COLORS[1], ls=":", label=label)
        figure.legend(loc="outside right upper")
        figure.savefig(path, dpi=120)
        pyplot.close(figure)
