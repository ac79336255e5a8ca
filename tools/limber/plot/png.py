"""Charts as one PNG, by matplotlib."""

import textwrap
from pathlib import Path

import matplotlib.pyplot as plt

from limber.plot.chart import Chart
from limber.plot.drawing import Drawing
from limber.plot.marks import Mark, Span
from limber.plot.style import COLORS, STYLE

EVENT, BAD = "0.55", "#C00000"
ROW_INCH, EVENT_INCH = 2.1, 0.16
LEVELS = 4
LISTED = 30  # events below the overview


def figure(topic: str, drawing: Drawing, other: Drawing | None = None) -> plt.Figure:
    """Charts below each other on a common time axis; those of `other` dotted in the same axes."""
    shown = drawing.topics[topic]
    listed = _listed(drawing) if topic == "overview" else []
    with plt.rc_context(STYLE):
        height = 1.2 + ROW_INCH * len(shown) + EVENT_INCH * len(listed)
        fig = plt.figure(figsize=(11, height), layout="constrained")
        fig.suptitle(_title(topic, drawing, other), fontsize=10)
        rows = [ROW_INCH] * len(shown) + ([EVENT_INCH * (len(listed) + 1)] if listed else [])
        grid = fig.add_gridspec(len(rows), 1, height_ratios=rows)
        first = None
        for row, chart in enumerate(shown):
            ax = fig.add_subplot(grid[row], sharex=first if chart.over_time else None)
            _draw(ax, chart, _same(chart, topic, other))
            if chart.over_time:
                _mark(ax, drawing.marks, drawing.spans, numbered=first is None)
                first = first or ax
            last = row == len(shown) - 1 or not shown[row + 1].over_time
            ax.tick_params(labelbottom=last)
            if last:
                ax.set_xlabel(chart.x)
        if listed:
            _list(fig.add_subplot(grid[len(shown)]), listed)
    return fig


def _title(topic: str, drawing: Drawing, other: Drawing | None) -> str:
    lines = [f"{drawing.title}: {topic}"]
    if other:
        lines.append(f"dotted: {other.title}")
    elif topic == "overview" and drawing.verdict:
        lines.append(drawing.verdict)
    return "\n".join(lines)


def _same(chart: Chart, topic: str, other: Drawing | None) -> Chart | None:
    charts = other.topics.get(topic, []) if other else []
    return next((one for one in charts if one.title == chart.title), None)


def _draw(ax: plt.Axes, chart: Chart, other: Chart | None) -> None:
    colors = [COLORS[number % len(COLORS)] for number in chart.color_numbers()]
    color_of = dict(zip(chart.series, colors, strict=True))
    stack = chart.stacked if other is None else set()
    for name, low, high in chart.areas() if stack else ():
        ax.fill_between(
            chart.t_s, low, high, label=name, color=color_of[name], alpha=0.6, linewidth=0
        )
    for name, values in chart.series.items():
        if name not in stack:
            style = "--" if name in chart.dashed else "-"
            ax.plot(chart.t_s, values, style, label=name, color=color_of[name])
    for name, values in other.series.items() if other else ():
        if name not in chart.dashed and name in color_of:
            ax.plot(other.t_s, values, ":", color=color_of[name], linewidth=1.6)
    if chart.log:
        ax.set_xscale("log")
        ax.set_yscale("log")
    if chart.zero:
        ax.set_ylim(bottom=0.0)
    ax.set_ylabel(_wrapped(chart), fontsize=8)
    ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=8)
    ax.margins(x=0)


def _mark(ax: plt.Axes, marks: list[Mark], spans: list[Span], numbered: bool) -> None:
    low, high = ax.get_xlim()
    for span in spans:
        begin, end = max(span.begin_s, low), min(span.end_s, high)
        if begin < end:
            ax.axvspan(begin, end, color=BAD if span.bad else "0.5", alpha=0.12, linewidth=0)
    free_from = [low] * LEVELS  # for numbers, at each height above the axes
    for mark in marks:
        if not low <= mark.time_s <= high:
            continue
        color = BAD if mark.bad else EVENT
        ax.axvline(mark.time_s, color=color, linewidth=0.7, linestyle=(0, (1, 2)))
        level = next((i for i, free in enumerate(free_from) if free <= mark.time_s), None)
        if numbered and level is not None:
            free_from[level] = mark.time_s + 0.012 * (high - low)
            ax.annotate(
                str(mark.number),
                (mark.time_s, 1.0),
                (0, 2 + 8 * level),
                xycoords=ax.get_xaxis_transform(),
                textcoords="offset points",
                ha="center",
                fontsize=7,
                color=color,
            )
    ax.set_xlim(low, high)


def _listed(drawing: Drawing) -> list[tuple[str, bool]]:
    """The events in words, as many as there is room for: what went wrong first of all."""
    kept = sorted(drawing.marks, key=lambda mark: not mark.bad)[:LISTED]
    lines = []
    for mark in sorted(kept, key=lambda mark: mark.number):
        text = textwrap.shorten(mark.text, 125, placeholder=" …")
        lines.append((f"{mark.number:>3}  {mark.time_s:8.3f} s  {text}", mark.bad))
    left_out = len(drawing.marks) - len(kept)
    if left_out:
        lines.append((f"     and {left_out} more: limber log events", False))
    return lines


def _list(ax: plt.Axes, lines: list[tuple[str, bool]]) -> None:
    ax.axis("off")
    for row, (line, bad) in enumerate(lines):
        y = 1 - (row + 1) / (len(lines) + 1)
        color = BAD if bad else "0.25"
        ax.text(0, y, line, family="monospace", fontsize=7, color=color, transform=ax.transAxes)


def _wrapped(chart: Chart) -> str:
    return "\n".join([*textwrap.wrap(chart.title, 18, break_long_words=False), f"({chart.unit})"])


def save(topic: str, drawing: Drawing, path: Path, other: Drawing | None = None) -> None:
    fig = figure(topic, drawing, other)
    fig.savefig(path, dpi=130)
    plt.close(fig)
