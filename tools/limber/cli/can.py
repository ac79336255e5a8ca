"""Commands for what is said on an arm's CAN buses: `limber can ...`."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from limber.cli.options import Bus, Robot, become, bus_words
from limber.paths import existing_file, output_folder, robot_folder

app = typer.Typer(help="Decode, count, record and replay CAN frames.", no_args_is_help=True)

DEFAULT_ROBOT = "openarm"
LogFile = Annotated[
    Path | None, typer.Option("--file", help="Frames of a candump log instead of the buses.")
]
Duration = Annotated[
    float, typer.Option(min=0.0, max=1e6, help="Seconds to listen; 0: until Ctrl-C.")
]


class Side(StrEnum):
    commands = "commands"
    replies = "replies"


@app.command(epilog="Example: limber can dump openarm")
def dump(
    robot: Robot = DEFAULT_ROBOT, bus: Bus = None, file: LogFile = None, duration: Duration = 0.0
) -> None:
    """Show every frame in words: joint, direction, values with units."""
    _listen("dump", robot, bus, file, duration)


@app.command(epilog="Example: limber can stats openarm --duration 10")
def stats(
    robot: Robot = DEFAULT_ROBOT, bus: Bus = None, file: LogFile = None, duration: Duration = 0.0
) -> None:
    """Count frames: rate and gaps of each identifier, load of each bus and the predicted one."""
    _listen("stats", robot, bus, file, duration)


@app.command(epilog="Example: limber can record frames.log")
def record(
    file: Annotated[Path, typer.Argument(help="File to write, in candump's log format.")],
    robot: Robot = DEFAULT_ROBOT,
    bus: Bus = None,
    duration: Duration = 0.0,
) -> None:
    """Record all buses of an arm, until Ctrl-C."""
    output_folder(file.parent)
    _become("record", robot, bus, "--out", str(file), "--duration", str(duration))


@app.command(epilog="Example: limber can replay frames.log")
def replay(
    file: Annotated[Path, typer.Argument(help="A candump log.")],
    robot: Robot = DEFAULT_ROBOT,
    bus: Bus = None,
    only: Annotated[Side | None, typer.Option(help="Send one direction alone.")] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Also on a bus that may carry a real arm: it may move.")
    ] = False,
) -> None:
    """Send a recording again, at its own pace."""
    words = ["--file", str(existing_file(file, "candump log"))]
    if only is not None:
        words += ["--only", only.value]
    if force:
        words.append("--force")
    _become("replay", robot, bus, *words)


@app.command(epilog="Example: limber can dbc openarm")
def dbc(
    robot: Robot,
    out: Annotated[Path, typer.Option("--out", help="Folder to write to.")] = Path(),
) -> None:
    """Write a DBC file for each bus: the frames of its drives, for other people's tools."""
    _become("dbc", robot, None, "--out", str(output_folder(out)))


def _listen(
    what: str, robot: str, bus: list[str] | None, file: Path | None, duration: float
) -> None:
    words = ["--duration", str(duration)]
    if file is not None:
        words += ["--file", str(existing_file(file, "candump log"))]
    _become(what, robot, bus, *words)


def _become(what: str, robot: str, bus: list[str] | None, *words: str) -> None:
    become("limber-can", what, str(robot_folder(robot)), *words, *bus_words(bus))
