"""Charts as one HTML page that needs nothing else, to zoom and read values in.

The drawing is uPlot's (MIT, assets/uPlot.LICENSE); the numbers are in the page as base64 float32.
"""

import base64
import html
import json
from pathlib import Path

import numpy as np

from limber.paths import ASSETS
from limber.plot.charts import Chart
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
    return Chart(chart.title, chart.unit, t, series, chart.dashed)


def _base64(values: np.ndarray) -> str:
    return base64.b64encode(np.ascontiguousarray(values, "<f4").tobytes()).decode("ascii")


def _as_dict(chart: Chart) -> dict:
    chart = thinned(chart)
    return {
        "title": chart.title,
        "unit": chart.unit,
        "t": _base64(chart.t_s),
        "series": [
            {
                "name": name,
                "color": COLORS[number % len(COLORS)],
                "dashed": name in chart.dashed,
                "values": _base64(values),
            }
            for (name, values), number in zip(
                chart.series.items(), chart.color_numbers(), strict=True
            )
        ],
    }


def page(topics: dict[str, list[Chart]], title: str) -> str:
    data = {topic: [_as_dict(chart) for chart in charts] for topic, charts in topics.items()}
    parts = {
        "TITLE": html.escape(title),
        "UPLOT_CSS": (ASSETS / "uPlot.min.css").read_text(encoding="utf-8"),
        "UPLOT_JS": (ASSETS / "uPlot.iife.min.js").read_text(encoding="utf-8"),
        "UPLOT_LICENSE": (ASSETS / "uPlot.LICENSE").read_text(encoding="utf-8"),
        # "</" would end the script element early
        "DATA": json.dumps(data).replace("</", "<\\/"),
    }
    text = (ASSETS / "plot.html").read_text(encoding="utf-8")
    for key, value in parts.items():
        text = text.replace(f"@{key}@", value)
    return text


def save(topics: dict[str, list[Chart]], title: str, path: Path) -> None:
    path.write_text(page(topics, title), encoding="utf-8")
