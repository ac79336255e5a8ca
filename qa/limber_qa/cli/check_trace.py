"""The command that judges a CAN trace: `limber dev check-trace`."""

import math
from pathlib import Path
from typing import Annotated

import typer

from limber.cli.options import Bus, console
from limber.errors import OK, OUT_OF_TOLERANCE, InputError
from limber.paths import existing_file

app = typer.Typer()

SHOWN = 40


@app.command("check-trace", epilog="Example: limber dev check-trace frames.log --robot openarm")
def check_trace(
    trace: Annotated[Path, typer.Argument(help="A candump log of all the arm's buses.")],
    robot: Annotated[str, typer.Option("--robot", "-r", help="Its name or folder.")] = "openarm",
    bus: Bus = None,
    fault_at: Annotated[
        float | None, typer.Option(min=0.0, help="A fault begins here, s, as the trace counts.")
    ] = None,
    stop_within: Annotated[
        float | None, typer.Option(min=0.0, help="First safe frame after it, ms.")
    ] = None,
    latched: Annotated[
        bool, typer.Option("--latched", help="Nobody acknowledged: no drive may follow again.")
    ] = False,
    bridged: Annotated[
        int, typer.Option(min=1, max=1000, help="Cycles for which replies may be missing.")
    ] = 5,
) -> None:
    """Judge an arm by its CAN frames and robot.yaml alone; 1 if a rule is broken."""
    from limber.tables import table
    from limber_qa.check_trace.judge import judge_file
    from limber_qa.check_trace.stops import Expectation

    expected = Expectation(
        None if fault_at is None else round(fault_at * 1e9),
        None if stop_within is None else round(stop_within * 1e6),
        latched,
        bridged,
    )
    trace = existing_file(trace, "candump log")
    verdict = judge_file(trace, robot, expected, _addresses(bus or []))
    if verdict.breaches:
        rows = table(">time, s", "<joint", "<rule", ">number", ">limit", "<unit", "~what")
        for breach in verdict.breaches[:SHOWN]:
            time_s = (breach.time_ns - verdict.start_ns) * 1e-9
            rows.add_row(
                f"{time_s:.4f}",
                breach.joint,
                f"[bold red]{breach.rule}[/]",
                _number(breach.number),
                _number(breach.limit),
                breach.unit,
                breach.text,
            )
        console.print(rows)
    more = len(verdict.breaches) - SHOWN
    if more > 0:
        console.print(f"and {more} more")
    stop = "" if verdict.stop_ms is None else f"; first safe frames after {verdict.stop_ms:g} ms"
    word = "[green]no breach[/]" if verdict.passed else f"[red]{len(verdict.breaches)} breaches[/]"
    console.print(f"{word}: {verdict.commands} commands, {verdict.states} states{stop}")
    raise typer.Exit(OK if verdict.passed else OUT_OF_TOLERANCE)


def _addresses(words: list[str]) -> dict[str, str]:
    """Of buses, from NAME=ADDR each."""
    addresses = {}
    for word in words:
        name, _, address = word.partition("=")
        kind, _, interface = address.partition(":")
        if kind not in ("virtual", "socketcan") or not interface:
            raise InputError(f"--bus {word}: expected NAME=virtual:NAME or NAME=socketcan:IFACE")
        addresses[name] = address
    return addresses


def _number(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.5g}"
