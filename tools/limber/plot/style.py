"""What all pictures share; importing it makes matplotlib draw to files."""

from typing import TYPE_CHECKING, Any

import matplotlib
from matplotlib.axes import Axes

if TYPE_CHECKING:
    from matplotlib.typing import LegendLocType, RcKeyType

matplotlib.use("Agg")

# Eight colours that stay apart for colour-blind readers (Okabe and Ito, 2008), without the yellow
COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#8B4513")
STYLE: dict["RcKeyType", Any] = {
    "axes.grid": True,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "font.size": 9,
    "grid.alpha": 0.3,
    "legend.frameon": False,
    "lines.linewidth": 1.1,
}


def name_axes(ax: Axes, x: str, y: str, legend: "LegendLocType | None" = None) -> None:
    """Names the axes; `legend` is the place of the legend, if there is one."""
    ax.set_xlabel(x)
    ax.set_ylabel(y)
    if legend is not None:
        ax.legend(loc=legend)


def note(
    ax: Axes, text: str, at: tuple[float, float], offset: tuple[float, float] = (0, 0), **style: Any
) -> None:
    """Words in a picture, `offset` points away from a place."""
    ax.annotate(text, at, offset, textcoords="offset points", **{"color": "0.35", **style})
