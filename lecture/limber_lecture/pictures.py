"""The style of all experiments' pictures."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from limber.arrays import Floats
from limber.plot.style import COLORS, STYLE, note
from limber.plot.style import name_axes as name_axes

if TYPE_CHECKING:
    from matplotlib.typing import RcKeyType

BLUE, ORANGE, GREEN, PINK, AMBER, SKY, BLACK, _ = COLORS
LOOK: dict["RcKeyType", Any] = {
    **STYLE,
    "font.size": 10,
    "axes.titlesize": 10.5,
    "axes.titlelocation": "left",
    "lines.linewidth": 1.6,
    "lines.markersize": 5.5,
}
ARROW = {"arrowprops": {"arrowstyle": "->"}, "color": "black"}  # of a note
# In every picture a formula is a line and a measurement an open circle. Where both have been
# measured, the circle is the robot on its bus and a cross its equations.
MEASURED: dict[str, Any] = {"marker": "o", "mfc": "white", "ls": "none", "mew": 1.5}
MARKS: dict[str, dict[str, Any]] = {
    "ideal": {"marker": "x", "ls": "none", "mew": 1.5, "ms": 6.5},
    "bus": MEASURED,
}
WAYS = {"ideal": "on the joint's equations", "bus": "measured on the bus"}


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


def plot_marks(ax: Axes, at: ArrayLike, ideal: ArrayLike, bus: ArrayLike, **style: Any) -> None:
    """What was measured both ways; the legend says so once for all colours."""
    named = {line.get_label() for line in ax.get_lines()}
    for where, values in (("ideal", ideal), ("bus", bus)):
        ax.plot(at, values, **MARKS[where], **style)
        if WAYS[where] not in named:
            ax.plot([], [], **MARKS[where], color="0.3", label=WAYS[where])


def ellipse(K: Floats) -> Floats:
    """2 x N points: stiffness along each direction, of the symmetric part of a 2 x 2 matrix."""
    angle = np.linspace(0, 2 * np.pi, 120)
    values, axes = np.linalg.eigh((K + K.T) / 2)
    found: Floats = axes @ (values[:, None] * np.array([np.cos(angle), np.sin(angle)]))
    return found


def level(
    ax: Axes,
    text: str,
    at: tuple[float, float],
    offset: tuple[float, float] = (0, 0),
    upright: bool = False,
    **style: Any,
) -> None:
    """A dotted line across the picture through `at`, or an `upright` one, and its name there."""
    if upright:
        ax.axvline(at[0], color="0.5", ls=":", lw=1)
    else:
        ax.axhline(at[1], color="0.5", ls=":", lw=1)
    note(ax, text, at, offset, **style)
