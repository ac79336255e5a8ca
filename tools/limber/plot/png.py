"""Charts as one PNG, by matplotlib."""

import textwrap
from dataclasses import replace
from pathlib import Path

import matplotlib.pyplot as plt

from limber.plot.chart import Chart
from limber.plot.drawing import Drawing
from limber.plot.marks import Mark, Span
from limber.plot.style import COLORS, STYLE
from limber.plot.thinning import binned, span_of, swings

EVENT, BAD, ZERO = "0.55", "#C00000", "0.45"
WIDTH_INCH, ROW_INCH, LOOP_INCH, EVENT_INCH = 11.0, 2.1, 4.2, 0.16
LEFT_INCH, BOTTOM_INCH, LINE_INCH, LETTER_INCH = 1.1, 0.5, 0.17, 0.064
LEVELS = 4
NUMBERS_INCH = 0.15 + 8 / 72 * LEVELS  # above the first axes
LISTED = 30  # events below the overview
BINS = 900  # across the picture
BANDS = "light bands: smallest to greatest where a value swings within a pixel; line: mean"


def figure(topic: str, drawing: Drawing, other: Drawing | None = None) -> plt.Figure:
    """Charts below each other on a common time axis; those of `other` dotted in the same axes."""
    shown = drawing.topics[topic]
    listed = _listed(drawing) if topic == "overview" else []
    with plt.rc_context(STYLE):
        rows = [LOOP_INCH if chart.loop else ROW_INCH for chart in shown]
        rows += [EVENT_INCH * (len(listed) + 1)] if listed else []
        title = _title(topic, drawing, other)
        above = LINE_INCH * (title.count("\n") + 2)
        above += NUMBERS_INCH if shown[0].over_time else 0.0
        height = above + sum(rows) + BOTTOM_INCH
        fig = plt.figure(figsize=(WIDTH_INCH, height))
        grid = fig.add_gridspec(
            len(rows),
            1,
            height_ratios=rows,
            left=LEFT_INCH / WIDTH_INCH,
            right=1 - _legend_inch(shown) / WIDTH_INCH,
            top=1 - above / height,
            bottom=BOTTOM_INCH / height,
            hspace=0.2 if listed or not all(chart.over_time for chart in shown) else 0.12,
        )
        first, bands = None, False
        for row, chart in enumerate(shown):
            ax = fig.add_subplot(grid[row], sharex=first if chart.over_time else None)
            bands |= _draw(ax, chart, _same(chart, topic, other))
            if chart.over_time:
                _mark(ax, drawing.marks, drawing.spans, numbered=first is None)
                first = first or ax
            last = row == len(shown) - 1 or not shown[row + 1].over_time
            ax.tick_params(labelbottom=last)
            if last:
                ax.set_xlabel(chart.x)
        if listed:
            _list(fig.add_subplot(grid[len(shown)]), listed)
        title += f"\n{BANDS}" if bands else ""
        fig.suptitle(title, fontsize=10, y=1 - 0.06 / height, va="top", parse_math=False)
    return fig


def _legend_inch(shown: list[Chart]) -> float:
    longest = max((len(name) for chart in shown for name in chart.series), default=0)
    return 0.55 + LETTER_INCH * longest


def _title(topic: str, drawing: Drawing, other: Drawing | None) -> str:
    lines = [f"{drawing.title}: {topic}"]
    if other:
        lines.append(f"dotted: {other.title}")
    elif topic == "overview" and drawing.verdict:
        lines.append(drawing.verdict)
    if still := drawing.constant.get(topic):
        lines += textwrap.wrap(f"constant, not drawn: {'; '.join(still)}", 150)
    return "\n".join(lines)


def _same(chart: Chart, topic: str, other: Drawing | None) -> Chart | None:
    charts = other.topics.get(topic, []) if other else []
    return next((one for one in charts if one.title == chart.title), None)


def _draw(ax: plt.Axes, chart: Chart, other: Chart | None) -> bool:
    """True if something is drawn as a band."""
    colors = [COLORS[number % len(COLORS)] for number in chart.color_numbers()]
    color_of = dict(zip(chart.series, colors, strict=True))
    stack = chart.stacked if other is None else set()
    lines = {name: binned(chart.t_s, values, BINS) for name, values in chart.series.items()}
    span, bands = span_of(chart), False
    if stack:
        means = {name: line.steady(span) for name, line in lines.items()}
        smooth = replace(chart, t_s=next(iter(lines.values())).t_s, series=means)
        for name, low, high in smooth.areas():
            color = color_of[name]
            ax.fill_between(smooth.t_s, low, high, label=name, color=color, alpha=0.6, linewidth=0)
    for name, line in lines.items():
        if name in stack:
            continue
        style, color = "--" if name in chart.dashed else "-", color_of[name]
        t, values = line.outline
        if chart.over_time and swings(line, span):
            ax.fill_between(line.t_s, line.low, line.high, color=color, alpha=0.22, linewidth=0)
            t, values, bands = line.t_s, line.steady(span), True
        ax.plot(t, values, style, label=name, color=color)
    if other is not None:
        for name in [n for n in other.series if n not in chart.dashed and n in color_of]:
            t, values = binned(other.t_s, other.series[name], BINS).outline
            ax.plot(t, values, ":", color=color_of[name], linewidth=1.6)
    _set_range(ax, chart)
    ax.set_ylabel(_wrapped(chart), fontsize=8, parse_math=False)
    legend = ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=8)
    for text in legend.get_texts():
        text.set_parse_math(False)
    ax.margins(x=0.03 if chart.loop else 0)
    return bands


def _set_range(ax: plt.Axes, chart: Chart) -> None:
    if chart.log:
        ax.set_xscale("log")
        ax.set_yscale("log")
        return
    if chart.loop:
        ax.axvline(0.0, color=ZERO, linewidth=0.8, zorder=1)
    low, high = ax.get_ylim()
    if chart.zero:
        ax.set_ylim(0.0, high if high > 0 else 1.0)
    elif chart.least:
        low, high = min(low, -chart.least), max(high, chart.least)
        ax.set_ylim(low, high)
    if low <= 0.0 <= high:
        ax.axhline(0.0, color=ZERO, linewidth=0.8, zorder=1)


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
