"""The results of a run: named numbers with expected value, tolerance and verdict."""

import json
import math
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from rich.table import Table

from limber import tables
from limber.errors import InputError
from limber.measure.faults import Fault
from limber.output import write_again


@dataclass
class Result:
    """`tolerance` is in the unit of the value. `passed` is None without an expected value."""

    name: str
    value: float | int | str | bool
    unit: str = ""
    expected: float | int | str | None = None
    tolerance: float | None = None
    passed: bool | None = None
    note: str = ""
    span: tuple[float, float] | None = None  # arm time it was measured in, s; not saved


def at_most(name: str, value: float, unit: str, limit: float, note: str = "") -> Result:
    return Result(name, value, unit, limit, 0.0, bool(value <= limit), note)


def close_to(
    name: str, value: float, unit: str, expected: float, tolerance: float, note: str = ""
) -> Result:
    """A value that is not a number never passes."""
    passed = bool(abs(value - expected) <= tolerance)
    return Result(name, float(value), unit, float(expected), float(tolerance), passed, note)


@dataclass
class Summary:
    header: dict[str, Any] = field(default_factory=dict)
    results: list[Result] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)

    @property
    def passed(self) -> bool:
        return all(result.passed is not False for result in self.results)

    def disturbed(self, span: tuple[float, float]) -> bool:
        """True if a fault lies in this time, or before it without the arm being ACTIVE again."""
        return any(fault.time_s < span[1] and fault.until_s > span[0] for fault in self.faults)

    def leave_out_disturbed(self) -> None:
        """What was measured after a fault is shown, not judged."""
        for result in self.results:
            if result.span is not None and self.disturbed(result.span):
                result.passed, result.note = None, "after the fault"

    def find(self, name: str) -> Result | None:
        return next((result for result in self.results if result.name == name), None)

    def save(self, path: Path) -> None:
        content = {
            **self.header,
            "pass": self.passed,
            "results": [_as_json(result) for result in self.results],
            "faults": [fault.as_json() for fault in self.faults],
        }
        write_again(path, json.dumps(content, indent=2, allow_nan=False) + "\n")

    def table(self, title: str) -> Table:
        table = tables.table("<", ">measured", ">expected", "<", "~", title=title)
        table.columns[-1].style = "dim"
        for result in self.results:
            value = f"{text(result.value)} {result.unit}".strip()
            judged = tables.verdict(result.passed)
            table.add_row(result.name, value, _expected(result), judged, result.note)
        return table


def _as_json(result: Result) -> dict[str, Any]:
    """JSON has no NaN and no infinity: they are null."""
    content = {
        key: None if isinstance(value, float) and not math.isfinite(value) else value
        for key, value in asdict(result).items()
    }
    content["pass"] = content.pop("passed")
    del content["span"]
    if not content["note"]:
        del content["note"]
    return content


def _expected(result: Result) -> str:
    if result.expected is None:
        return ""
    within = f" ± {text(result.tolerance)}" if result.tolerance else ""
    return text(result.expected) + within


def text(value: float | int | str | bool) -> str:
    """As it is shown."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def load_header(folder: Path) -> dict[str, Any]:
    """The summary a run left; used to measure it again."""
    path = folder / "summary.json"
    try:
        header: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, json.JSONDecodeError) as error:
        raise InputError(f"{folder} holds no readable summary.json: give a run's folder") from error
    return header
