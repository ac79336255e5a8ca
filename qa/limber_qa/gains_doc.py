"""The tables of gains in scenarios/README.md, written from what the controller lists."""

from typing import Any

from limber.model.gains_table import listing
from limber.paths import ROOT
from limber_qa.written_table import WrittenTable


def _number(value: float) -> str:
    return f"{value:g}".replace("e+0", "e").replace("e+", "e")


def _range(row: dict[str, Any]) -> str:
    bounds = f"{_number(row['low'])} to {_number(row['high'])}"
    if "high_rotation" in row:
        bounds += f", rotation to {_number(row['high_rotation'])}"
    return f"{bounds} {row.get('unit', '')}".strip()


def _default(row: dict[str, Any]) -> str:
    value = row["default"]
    if value == "robot.yaml":
        return "`robot.yaml`"
    return f"`{value}`" if isinstance(value, str) else _number(value)


def _meaning(row: dict[str, Any]) -> str:
    if row["kind"] == "joints":
        return f"{row['meaning']}; one number, or one a joint"
    if row["kind"] == "periods":
        words = ", ".join(f"`{word['word']}`" for word in row["words"])
        return f"{row['meaning']}: a map of {words}"
    meaning: str = row["meaning"]
    return meaning


def _words(row: dict[str, Any]) -> str:
    marked = (f"`{w['word']}`" + ("*" if w["demonstration"] else "") for w in row["words"])
    return ", ".join(marked)


def _row(row: dict[str, Any], law: str | None = None) -> str:
    values = _words(row) if row["kind"] in ("choice", "switch") else _range(row)
    cells = [f"`{row['key']}`", _meaning(row), values, _default(row)]
    if law is not None:
        cells.insert(1, f"`{law}`")
    return "| " + " | ".join(cells) + " |"


def _lines() -> list[str]:
    found = listing()
    numbers = [row for row in found["gains"] if row["kind"] not in ("choice", "switch")]
    choices = [row for row in found["gains"] if row["kind"] in ("choice", "switch")]
    lines = ["| number | what | range, unit | default |", "|---|---|---|---|"]
    lines += [_row(row) for row in numbers]
    lines += ["", "| choice | what | words | default |", "|---|---|---|---|"]
    lines += [_row(row) for row in choices]
    lines += [
        "",
        "Parameters of single laws:",
        "",
        "| key | law | what | range or words | default |",
    ]
    lines += ["|---|---|---|---|---|"]
    lines += [_row(row, law["name"]) for law in found["laws"] for row in law["parameters"]]
    lines += ["", "*: demonstrates a mistake; refused unless every bus is simulated."]
    return lines


TABLE = WrittenTable(ROOT / "scenarios" / "README.md", "gains", _lines)
