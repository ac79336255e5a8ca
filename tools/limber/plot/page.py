"""A drawing as one HTML page that needs nothing else, to zoom and read values in.

The drawing is uPlot's (MIT, assets/uPlot.LICENSE); the numbers are in the page as base64 float32.
"""

import base64
import html
import json
import re
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from limber.output import write_again
from limber.paths import ASSETS
from limber.plot.chart import Chart
from limber.plot.drawing import Drawing, Figure
from limber.plot.style import COLORS
from limber.plot.thinning import MAX_POINTS, thinned

PLACE = re.compile("@(TITLE|UPLOT_CSS|UPLOT_JS|UPLOT_LICENSE|DATA)@")
BYTES = 2_300_000  # of all series together, in base64 float32: with the rest below 3 MB
BYTES_A_NUMBER = 4 * 4 / 3
FEWEST_POINTS = 400  # of a series


def points_each(*drawings: Drawing | None) -> int:
    """How many points of each series there is room for."""
    charts = [c for one in drawings if one for charts in one.topics.values() for c in charts]
    series = sum(len(chart.series) + 1 for chart in charts)
    points = int(BYTES / BYTES_A_NUMBER / max(series, 1))
    return min(max(points, FEWEST_POINTS), MAX_POINTS)


def _base64(values: np.ndarray) -> str:
    return base64.b64encode(np.ascontiguousarray(values, "<f4").tobytes()).decode("ascii")


def _as_dict(chart: Chart, points: int) -> dict[str, Any]:
    chart = thinned(chart, points)
    return {
        "title": chart.title,
        "unit": chart.unit,
        "x": chart.x,
        "over_time": chart.over_time,
        "log": chart.log,
        "loop": chart.loop,
        "zero": chart.zero,
        "least": chart.least,
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


def _data(drawing: Drawing, points: int) -> dict[str, Any]:
    """JSON has no infinity and no NaN: `results` are read from JSON that had none."""
    return {
        "title": drawing.title,
        "verdict": drawing.verdict,
        "results": drawing.results,
        "marks": [asdict(mark) for mark in drawing.marks],
        "spans": [asdict(span) for span in drawing.spans],
        "figure": _figure(drawing.figure),
        "constant": drawing.constant,
        "topics": {
            topic: [_as_dict(c, points) for c in charts] for topic, charts in drawing.topics.items()
        },
    }


def page(drawing: Drawing, other: Drawing | None = None) -> str:
    points = points_each(drawing, other)
    data = {"run": _data(drawing, points), "other": _data(other, points) if other else None}
    parts = {
        "TITLE": html.escape(drawing.title),
        "UPLOT_CSS": (ASSETS / "uPlot.min.css").read_text(encoding="utf-8"),
        "UPLOT_JS": (ASSETS / "uPlot.iife.min.js").read_text(encoding="utf-8"),
        "UPLOT_LICENSE": (ASSETS / "uPlot.LICENSE").read_text(encoding="utf-8"),
        # no word of a name may end the script element, or begin a comment in it
        "DATA": json.dumps(data, allow_nan=False).replace("<", "\\u003c"),
    }
    text = (ASSETS / "plot.html").read_text(encoding="utf-8")
    return PLACE.sub(lambda place: parts[place[1]], text)  # at once: a name may be @DATA@


def save(drawing: Drawing, path: Path, other: Drawing | None = None) -> None:
    write_again(path, page(drawing, other))
