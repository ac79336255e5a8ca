"""Samples and fits of an identification, a panel a joint, by matplotlib."""

from pathlib import Path

import matplotlib.pyplot as plt

from limber.identify.findings import Panel
from limber.plot.style import COLORS, STYLE

COLUMNS = 3


def save(panels: list[Panel], title: str, path: Path) -> Path:
    columns = min(len(panels), COLUMNS)
    rows = -(-len(panels) // columns)
    with plt.rc_context(STYLE):
        fig, axes = plt.subplots(
            rows, columns, squeeze=False, figsize=(4.4 * columns, 3.4 * rows), layout="constrained"
        )
        fig.suptitle(title)
        for ax, panel in zip(axes.flat, panels, strict=False):
            _draw(ax, panel)
        for ax in axes.flat[len(panels) :]:
            ax.set_axis_off()
        fig.savefig(path, dpi=130)
        plt.close(fig)
    return path


def _draw(ax: plt.Axes, panel: Panel) -> None:
    ax.plot(panel.x, panel.y, ".", color="0.6", markersize=2.5, label="samples")
    for name, y in panel.others.items():
        ax.plot(panel.x, y, ".", color=COLORS[1], markersize=2.0, label=name)
    for (name, (x, y)), color, style in zip(panel.lines.items(), COLORS, ("-", "--"), strict=False):
        ax.plot(x, y, style, color=color, label=name, linewidth=1.5)
    ax.set_title(panel.title, fontsize=9)
    ax.set_xlabel(panel.x_label, fontsize=8)
    ax.set_ylabel(panel.y_label, fontsize=8)
    ax.legend(fontsize=7)
