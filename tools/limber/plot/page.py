"""A drawing as one HTML page that needs nothing else, to zoom and read values in.

The drawing is uPlot's (MIT, assets/uPlot.LICENSE); the numbers are in the page as base64 float32.
"""

import base64
import html
import json
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from limber.paths import ASSETS
from limber.plot.chart import Chart
from limber.plot.drawing import Drawing, Figure
from limber.plot.style import COLORS

MAX_POINTS = 60_000


def thinned(chart: Chart) -> Chart:
    """At most MAX_POINTS; smallest and greatest of each bin stay, so no spike is lost."""
    count = len(chart.t_s)
    if count <= MAX_POINTS:
        return chart
    starts = np.linspace(0, count, MAX_POINTS // 2, endpoint=False).astype(int)
    t = np.repeat(chart.t_s[starts], 2)
    series = {}
    for name, values in chart.series.items():
        ends = (np.minimum.reduceat(values, starts), np.maximum.reduceat(values, starts))
        series[name] = np.column_stack(ends).ravel()
    return replace(chart, t_s=t, series=series)


def _base64(values: np.ndarray) -> str:
    return base64.b64encode(np.ascontiguousarray(values, "<f4").tobytes()).decode("ascii")


def _as_dict(chart: Chart) -> dict[str, Any]:
    chart = thinned(chart)
    return {
        "title": chart.title,
        "unit": chart.unit,
        "x": chart.x,
        "over_time": chart.over_time,
        "log": chart.log,
        "zero": chart.zero,
        "t": _base64(chart.t_s),
        "series": [
            {
                "name": name,
                "color": COLORS[number % len(COLORS)],
                "dashed": name in chart.dashed,
                "stacked": name in chart.stacked,
                "values": _base64(values),
            }
            for (name, values), number in zip(
                chart.series.items(), chart.color_numbers(), strict=True
            )
        ],
    }


def _figure(figure: Figure | None) -> dict[str, Any] | None:
    if figure is None:
        return None
    return {
        "t": _base64(figure.t_s),
        "points": figure.places.shape[1],
        "places": _base64(figure.places),
        "low": figure.low.tolist(),
        "high": figure.high.tolist(),
    }


def _data(drawing: Drawing) -> dict[str, Any]:
    """JSON has no infinity and no NaN: `results` are read from JSON that had none."""
    return {
        "title": drawing.title,
        "verdict": drawing.verdict,
        "results": drawing.results,
        "marks": [asdict(mark) for mark in drawing.marks],
        "spans": [asdict(span) for span in drawing.spans],
        "figure": _figure(drawing.figure),
        "topics": {
            topic: [_as_dict(c) for c in charts] for topic, charts in drawing.topics.items()
        },
    }


def page(drawing: Drawing, other: Drawing | None = None) -> str:
    data = {"run": _data(drawing), "other": _data(other) if other else None}
    parts = {
        "TITLE": html.escape(drawing.title),
        "UPLOT_CSS": (ASSETS / "uPlot.min.css").read_text(encoding="utf-8"),
        "UPLOT_JS": (ASSETS / "uPlot.iife.min.js").read_text(encoding="utf-8"),
        "UPLOT_LICENSE": (ASSETS / "uPlot.LICENSE").read_text(encoding="utf-8"),
        # "</" would end the script element early
        "DATA": json.dumps(data, allow_nan=False).replace("</", "<\\/"),
    }
    text = (ASSETS / "plot.html").read_text(encoding="utf-8")
    for key, value in parts.items():
        text = text.replace(f"@{key}@", value)
    return text


def save(drawing: Drawing, path: Path, other: Drawing | None = None) -> None:
    path.write_text(page(drawing, other), encoding="utf-8")
