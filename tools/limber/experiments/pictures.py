"""One look for all experiments' pictures."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from limber.plot_png import COLORS, STYLE

BLUE, ORANGE, GREEN, PINK, AMBER, SKY, BLACK, BROWN = COLORS
LOOK = {
    **STYLE,
    "font.size": 10,
    "axes.titlesize": 10.5,
    "axes.titlelocation": "left",
    "lines.linewidth": 1.6,
    "lines.markersize": 5.5,
}
# What a formula says is a line, what was measured is an open circle: in every picture
MEASURED = {"marker": "o", "mfc": "white", "ls": "none", "mew": 1.5}


@contextmanager
def picture(
    path: Path, title: str, rows: int, columns: int, size: tuple[float, float]
) -> Iterator[Any]:
    """`title` states what the picture shows as a sentence."""
    with plt.rc_context(LOOK):
        fig, axes = plt.subplots(rows, columns, figsize=size, layout="constrained")
        try:
            fig.suptitle(title, x=0.01, ha="left", fontsize=12.5, fontweight="bold")
            yield axes
            fig.savefig(path, dpi=130)
        finally:
            plt.close(fig)
