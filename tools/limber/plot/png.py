"""Charts as one PNG, by matplotlib."""

from pathlib import Path

import matplotlib.pyplot as plt

from limber.plot.charts import Chart
from limber.plot.style import COLORS, STYLE


def figure(charts: list[Chart], title: str) -> plt.Figure:
    """Charts below each other on a common time axis."""
    with plt.rc_context(STYLE):
        fig, axes = plt.subplots(
            len(charts),
            1,
            sharex=True,
            squeeze=False,
            figsize=(11, 1.0 + 2.1 * len(charts)),
            layout="constrained",
        )
        fig.suptitle(title)
        for ax, chart in zip(axes[:, 0], charts, strict=True):
            _draw(ax, chart)
        axes[-1, 0].set_xlabel("arm time (s)")
    return fig


def _draw(ax: plt.Axes, chart: Chart) -> None:
    for (name, values), number in zip(chart.series.items(), chart.color_numbers(), strict=True):
        style = "--" if name in chart.dashed else "-"
        ax.plot(chart.t_s, values, style, label=name, color=COLORS[number % len(COLORS)])
    ax.set_ylabel(_wrapped(chart), fontsize=8)
    ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=8)
    ax.margins(x=0)


def _wrapped(chart: Chart) -> str:
    words, lines = chart.title.split(), [""]
    for word in words:
        if len(lines[-1]) + len(word) > 18:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip()
    return "\n".join([*lines, f"({chart.unit})"])


def save(charts: list[Chart], title: str, path: Path) -> None:
    fig = figure(charts, title)
    fig.savefig(path, dpi=130)
    plt.close(fig)
