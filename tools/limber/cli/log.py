"""Commands that read recorded logs: `limber log ...` and `limber plot`."""

from pathlib import Path
from typing import Annotated

import typer

from limber.cli.options import LogPath, Out, console, names_of

app = typer.Typer()
log_app = typer.Typer(help="Inspect and convert recorded logs.", no_args_is_help=True)
app.add_typer(log_app, name="log")


@log_app.command()
def info(path: LogPath) -> None:
    """List the channels of a log, lost messages and damage."""
    from limber.log import commands

    commands.info(path, console)


@log_app.command()
def rate(path: LogPath) -> None:
    """Show rate and jitter of each channel."""
    from limber.log import commands

    commands.rate(path, console)


@log_app.command()
def events(
    path: LogPath,
    robot: Annotated[
        str | None,
        typer.Option(help="For the joints' names; default: the robot.yaml beside the log."),
    ] = None,
) -> None:
    """List what happened when: modes, requests, refusals, faults, limits, pushes, contacts."""
    from limber.log import commands

    folder = path if path.is_dir() else path.parent
    known = robot or (str(folder.resolve()) if (folder / "robot.yaml").is_file() else None)
    commands.show_events(path, names_of(known), console)


@log_app.command()
def echo(
    path: LogPath,
    channel: Annotated[str, typer.Argument(help="Such as JOINT_STATE.")],
    field: Annotated[str | None, typer.Option(help="Only this field.")] = None,
    count: Annotated[int, typer.Option(min=1, help="Number of messages.")] = 1,
    at: Annotated[float, typer.Option(min=0.0, help="From this arm time on, s.")] = 0.0,
) -> None:
    """Print messages, one field a line."""
    from limber.log import commands

    commands.echo(path, channel, field, count, at)


@log_app.command()
def convert(
    path: LogPath,
    out: Annotated[
        Path, typer.Option("--out", help="FILE.npz, or a folder for one CSV a channel.")
    ],
) -> None:
    """Convert a log to numpy (.npz) or CSV."""
    from limber.log import commands

    commands.convert(path, out, console)


@app.command()
def plot(
    path: LogPath,
    what: Annotated[
        list[str] | None,
        typer.Option(
            help="overview, joint, cartesian, torque, spring, timing or bus; default: all."
        ),
    ] = None,
    out: Out = None,
    compare: Annotated[
        Path | None, typer.Option(help="Another log, or folder of a run, drawn dotted beside it.")
    ] = None,
) -> None:
    """Draw a log: one PNG a topic, and one interactive page that works offline."""
    from limber.plot import commands

    commands.plot(path, what or [], out, console, compare)
