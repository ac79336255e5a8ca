"""What the check has found: the table at the end, and the same as data."""

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path

from rich.console import Console
from rich.text import Text

from limber import tables
from limber.joint_check.wiring import Change, change_words
from limber.joint_check.words import amount_words
from limber.output import write_again

OK, SKIPPED, NOT_CHECKED = "ok", "skipped", "not checked"
STYLES = {OK: "green", SKIPPED: "yellow", NOT_CHECKED: "yellow"}


@dataclass(frozen=True)
class Row:
    """One joint. `moved`: rad or m, of the joint that moved; `text`: what is wrong."""

    joint: str
    verdict: str = NOT_CHECKED  # ok, sign, exchanged, link encoder, skipped, not checked
    moved: float | None = None
    moved_joint: str = ""
    slides: bool = False
    text: str = ""
    changes: list[Change] = field(default_factory=list)

    def moved_words(self) -> str:
        if self.moved is None:
            return ""
        amount = f"{'+' if self.moved >= 0 else '-'}{amount_words(self.moved, self.slides)}"
        return amount if self.moved_joint == self.joint else f"{self.moved_joint} {amount}"


def passed(rows: list[Row]) -> bool:
    return all(row.verdict == OK for row in rows)


def print_table(rows: list[Row], console: Console) -> None:
    table = tables.table("<joint", "<verdict", ">moved by", "~what to change")
    for row in rows:
        table.add_row(
            row.joint,
            Text(row.verdict, style=STYLES.get(row.verdict, "bold red")),
            row.moved_words(),
            "\n".join(change_words(change) for change in row.changes),
        )
    console.print(table)


def conclusion(rows: list[Row]) -> str:
    wrong = [row.joint for row in rows if row.verdict not in STYLES]
    left = [row.joint for row in rows if row.verdict in (SKIPPED, NOT_CHECKED)]
    parts = []
    if wrong:
        parts.append(
            f"Wrong: {', '.join(wrong)}. Change robot.yaml as above, then run this check again."
        )
    if left:
        parts.append(f"Not known: {', '.join(left)}: these joints have not been tried.")
    return " ".join(parts) or "Every joint is its own motor's and turns the right way."


def write_json(rows: list[Row], robot: Path, path: Path) -> None:
    content = {
        "robot": str(robot),
        "passed": passed(rows),
        "joints": [{**asdict(row), "unit": "m" if row.slides else "rad"} for row in rows],
    }
    write_again(path, json.dumps(content, indent=2) + "\n")
