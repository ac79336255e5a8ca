"""The live table of a step: each joint's angle, its change, and a bar."""

import numpy as np
from rich.console import Group
from rich.table import Table
from rich.text import Text

from limber import tables
from limber.joint_check.judge import OTHER, Step

SIDE = 10  # characters of the bar to each side
GOOD, WARN, BAD = "green", "yellow", "bold red"


def picture(names: list[str], slides: list[bool], step: Step, texts: list[str]) -> Group:
    """`texts`: what to do, what is awaited, and which keys there are."""
    table = tables.table("<", "<joint", ">position", ">change", "<", padding=(0, 1))
    for i, name in enumerate(names):
        _row(table, step, i, name, "m" if slides[i] else "rad")
    *above, below = texts
    return Group(*(Text(text) for text in above), table, Text(below, style="dim"))


def _row(table: Table, step: Step, i: int, name: str, unit: str) -> None:
    asked, known = i == step.joint, bool(np.isfinite(step.q[i]))
    counts = known and step.at_rest
    table.add_row(
        "►" if asked else "",
        Text(name, style="bold" if asked else ""),
        f"{step.q[i]:+.3f} {unit}" if known else Text("no reading", style=BAD),
        f"{step.change[i]:+.3f} {unit}" if counts else "",
        bar(step.shares[i], step.way if asked else 0) if counts else "",
    )


def bar(share: float, way: int) -> Text:
    """From the middle as far as the joint moved; `way`: the side asked for, 0 for none."""
    length = min(round(abs(share) * SIDE), SIDE)
    full, empty = "█" * length, "─" * (SIDE - length)
    sides = ("─" * SIDE, full + empty) if share >= 0 else (empty + full, "─" * SIDE)
    style = WARN if abs(share) > OTHER else "dim"
    if way:
        style = GOOD if share * way >= 0 else BAD
    return Text("┼".join(sides), style=style)


def awaited(names: list[str], step: Step) -> str:
    """What the step waits for."""
    if step.missing:
        return f"Waiting for fresh readings of {_listed(names, step.missing)}."
    if step.at_rest:
        return "Waiting for your hand."
    if step.moving:
        return f"Waiting until the arm is at rest: {_listed(names, step.moving)} moves."
    return "Waiting until the arm is at rest."


def _listed(names: list[str], joints: tuple[int, ...]) -> str:
    return ", ".join(names[i] for i in joints)
