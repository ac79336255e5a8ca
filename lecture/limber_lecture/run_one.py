"""Runs one experiment and leaves result.json, picture.png and about.json in its folder."""

import json
import os
import time
import traceback
from datetime import UTC, datetime
from pathlib import Path

from rich.console import Console
from rich.table import Table

from limber import __version__, tables
from limber.errors import InputError, RunError
from limber.paths import output_folder
from limber_lecture.catalog import Experiment
from limber_lecture.comparison import Comparison
from limber_lecture.context import PICTURE, make_context

RESULT, ABOUT, ERROR = "result.json", "about.json", "error.txt"


def run_one(experiment: Experiment, out: Path, console: Console) -> list[Comparison]:
    """Files of an earlier run are removed first, so that a failure leaves no old success."""
    folder = output_folder(out / experiment.id)
    for name in (RESULT, ABOUT, ERROR, PICTURE):
        (folder / name).unlink(missing_ok=True)
    start = time.monotonic()
    try:
        checks = experiment.run(make_context(experiment, folder, console))
        _require(experiment, checks, folder)
    except Exception as error:
        (folder / ERROR).write_text(traceback.format_exc(), encoding="utf-8")
        if os.environ.get("LIMBER_DEBUG") == "1":
            raise
        text = " ".join(str(error).split()) or type(error).__name__
        raise RunError(f"{experiment.id}: {text} (more in {folder / ERROR})") from error
    _write(folder / RESULT, [check.as_json() for check in checks])
    _write(folder / ABOUT, _about(experiment, time.monotonic() - start))
    return checks


def _require(experiment: Experiment, checks: list[Comparison], folder: Path) -> None:
    if not checks or not all(isinstance(check, Comparison) for check in checks):
        raise InputError("run(context) has to return a list of Comparison, at least one")
    names = [check.name for check in checks]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise InputError(f"two checks are named '{twice[0]}'")
    if not (folder / PICTURE).is_file():
        raise InputError("run(context) drew nothing: use context.picture")


def _about(experiment: Experiment, seconds: float) -> dict:
    return {
        "id": experiment.id,
        "title": experiment.title,
        "plant": experiment.plant,
        "version": __version__,
        "date": datetime.now(UTC).strftime("%Y-%m-%d"),
        "seconds": round(seconds, 1),
    }


def _write(path: Path, content: list | dict) -> None:
    text = json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False)
    path.write_text(text + "\n", encoding="utf-8")


def summary(rows: list[dict], title: str) -> Table:
    """`rows` as in result.json."""
    columns = ("~", ">predicted", ">measured", ">tolerance", "<")
    drawn = tables.table(*columns, title=title)
    for row in rows:
        drawn.add_row(row["name"], *numbers(row), tolerance(row), tables.verdict(row["pass"]))
    return drawn


def numbers(row: dict) -> list[str]:
    """Predicted and measured, with unit."""
    return [number(row[key], row["unit"]) for key in ("predicted", "measured")]


def number(value: float | None, unit: str) -> str:
    """Four digits; 209 600 rather than 2.096e+05."""
    if value is None:
        return "not a number"
    rounded = float(f"{value:.4g}")
    large = 1e4 <= abs(rounded) < 1e7
    digits = f"{rounded:,.0f}".replace(",", "\u202f") if large else f"{value:.4g}"
    return f"{digits} {unit}".strip()


def tolerance(row: dict) -> str:
    value, kind = row["tolerance"], row["kind"]
    if kind == "relative":
        return f"{value * 100:.3g} %"
    if kind == "absolute":
        return f"± {number(value, row['unit'])}"
    margin = f" (+{value:.2g})" if value else ""
    return {"at_most": "at most", "at_least": "at least"}[kind] + margin
