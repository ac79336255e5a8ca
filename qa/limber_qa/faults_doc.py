"""Faults on the bus and what the driver makes of them; the table in docs/bus.md."""

import json
import re
import subprocess
from typing import Any

from limber.messages import constants
from limber.model.protocols import protocols
from limber.paths import ROOT, program
from limber.problems import problem
from limber_qa.written_table import WrittenTable

COUNTERS = ("lost", "late", "invalid", "foreign")
ADDRESS = re.compile(r" \((?:id 0x[0-9a-f]+|(?:servo|node|motor) \d+)\)")  # behind a joint's name


def reactions(fault: str | None = None, phases: int = 3) -> list[dict[str, Any]]:
    """Injects the faults of the bus, or one of any place: a row each, as limber-faults prints."""
    command = [str(program("limber-faults")), "--phases", str(phases)]
    command += ["--place", "bus"] if fault is None else [fault]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    rows: list[dict[str, Any]] = json.loads(done.stdout)["faults"]
    return rows


def reaction_text(cell: dict[str, Any] | None) -> str:
    """ "FALLBACK +3, FAULT +20", "bridged: 1 lost"."""
    if cell is None:
        return ""
    least, most = cell["cycles"]
    if most < 0:
        counted = [f"{cell[key]} {key}" for key in COUNTERS if cell[key]]
        return "bridged: " + ", ".join(counted)
    state = constants("joint_state_t", "DRIVE_")[cell["state"]].replace("HOLD", "FALLBACK")
    cycles = f"+{most}" if least == most else f"+{least} to {most}"
    text = f"{state} {cycles}"
    if state != "FAULT" and cell["fault_cycles"] >= 0:
        text += f", FAULT +{cell['fault_cycles']}"
    return text


def cause_text(row: dict[str, Any]) -> str:
    """The code of JOINT_STATE.fault and the words behind it, without addresses and remedies; of
    each family where they differ, the first three.
    """
    found: list[str] = []
    for cell in row["families"].values():
        if cell["cycles"][1] < 0:
            continue
        words = cell["text"].replace(cell["bus"], "NAME").replace(cell["joint_name"], "JOINT")
        words = re.sub(r"JOINT to \w+", "JOINT to JOINT", ADDRESS.sub("", words)).split("; ")[0]
        cause = problem("driver", cell["cause"])
        text = (cause.code if cause else "none") + (f": {words}" if words else "")
        if text not in found:
            found.append(text)
    return "; ".join(found[:3]) + ("; ..." if len(found) > 3 else "")


def reactions_text(row: dict[str, Any]) -> str:
    """One reaction if all families have it, else each with its families; that of most comes last,
    without them.
    """
    families: dict[str, list[str]] = {}
    for entry in protocols():
        text = reaction_text(row["families"].get(entry.word))
        families.setdefault(text, []).append(entry.title)
    if len(families) == 1:
        return next(iter(families))
    usual = max(families, key=lambda text: len(families[text]))
    if "" not in families and len(families[usual]) > len(protocols()) / 2:
        del families[usual]
        families[usual] = ["others"]
    return "; ".join(f"{', '.join(names)}: {text}" for text, names in families.items() if text)


def cells(row: dict[str, Any]) -> list[str]:
    """Fault, its reaction, cause."""
    return [row["name"], reactions_text(row), cause_text(row)]


HEAD = ["fault", "reaction", "code: words"]


def _lines() -> list[str]:
    rows = [HEAD, ["---"] * len(HEAD), *(cells(row) for row in reactions())]
    return ["| " + " | ".join(row) + " |" for row in rows]


TABLE = WrittenTable(ROOT / "docs" / "bus.md", "faults", _lines)
