"""Commands that read recorded logs: `limber log ...` and `limber plot`."""

from pathlib import Path
from typing import Annotated

import typer

from limber.cli import groups
from limber.cli.options import LogPath, Out, console, names_of

JOINTS_OF = "For the joints' names; default: the robot.yaml beside the log."
ONLY = "Only these, such as JOINT_STATE,SIM_TRUTH; default: all."
Begin = Annotated[float, typer.Option("--from", min=0.0, help="Seconds since the first message.")]
End = Annotated[
    float | None, typer.Option("--to", min=0.0, help="Seconds since the first message.")
]

Run = Annotated[
    int | None,
    typer.Option("--run", min=1, help="Which, if the log holds several runs; see limber log info."),
]

app = typer.Typer()


@groups.log.command(epilog="Example: limber log info out/demo-1")
def info(path: LogPath) -> None:
    """List the channels of a log, lost messages and damage."""
    from limber.log import commands

    commands.info(path, console)


@groups.log.command(epilog="Example: limber log rate out/demo-1")
def rate(path: LogPath, run: Run = None) -> None:
    """Show rate and jitter of each channel, run by run."""
    from limber.log import commands

    commands.rate(path, run, console)


@groups.log.command(epilog="Example: limber log events out/demo-1")
def events(
    path: LogPath,
    robot: Annotated[str | None, typer.Option(help=JOINTS_OF)] = None,
    run: Run = None,
) -> None:
    """List what happened when: modes, requests, refusals, faults, limits, pushes, contacts."""
    from limber.log import commands

    commands.show_events(path, run, names_of(_robot_of(path, robot)), console)


@groups.log.command(epilog="Example: limber log echo out/demo-1 JOINT_STATE --field q --at 2.5")
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


@groups.log.command(epilog="Example: limber log convert out/demo-1 --to mcap")
def convert(
    path: LogPath,
    to: Annotated[
        str | None,
        typer.Option(
            help="csv, parquet, mcap, rerun, npz, lerobot or lcm; default: by the end of --out."
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", help="File, or folder for csv and parquet; default: beside the log."),
    ] = None,
    channels: Annotated[str, typer.Option(help=ONLY)] = "",
    robot: Annotated[str | None, typer.Option(help=JOINTS_OF)] = None,
    run: Run = None,
) -> None:
    """Convert a log for other tools: Foxglove, PlotJuggler, Rerun, pandas, spreadsheets, LCM."""
    from limber.log.convert import conversion

    names = names_of(_robot_of(path, robot))
    conversion.convert(path, to, out, _names(channels), names, console, run)


@groups.log.command(epilog="Example: limber log episodes picks.lcmlog.zst --drop 2")
def episodes(
    path: LogPath,
    drop: Annotated[
        list[int] | None, typer.Option(min=1, help="Leave out what this one holds; it stays.")
    ] = None,
    keep: Annotated[list[int] | None, typer.Option(min=1, help="Takes --drop back.")] = None,
    plot: Annotated[
        Path | None, typer.Option(help="Picture to write (.png): episodes over each other.")
    ] = None,
    only: Annotated[
        list[int] | None, typer.Option(min=1, help="In the picture; default: all but dropped.")
    ] = None,
) -> None:
    """List the episodes that were marked while recording, drop some, draw them."""
    from limber.log import episodes as module

    if drop or keep:
        module.mark(path, drop or [], keep or [])
    module.show(path, console)
    if plot:
        from limber.plot import episodes as picture

        picture.draw(path, only or [], plot, names_of(_robot_of(path, None)).joints, console)


@groups.log.command(epilog="Example: limber log cut out/demo-1 --to 8 --out push.lcmlog.zst")
def cut(
    path: LogPath,
    out: Annotated[
        Path, typer.Option("--out", help="Log to write; compressed if it ends in .zst.")
    ],
    begin: Begin = 0.0,
    end: End = None,
    channels: Annotated[str, typer.Option(help=ONLY)] = "",
    run: Run = None,
) -> None:
    """Copy a part of a log into a log of its own."""
    from limber.log import cut as module

    part = module.Part(begin, _until(end), tuple(_names(channels)), run)
    module.cut(path, out, part, console)


def _robot_of(path: Path, robot: str | None) -> str | None:
    """As given, or the folder of the log if it holds a robot.yaml."""
    folder = path if path.is_dir() else path.parent
    beside = str(folder.resolve()) if (folder / "robot.yaml").is_file() else None
    return robot or beside


@groups.log.command(epilog="Example: limber log replay out/demo-1 --speed 0.5 --from 3 --to 8")
def replay(
    path: LogPath,
    speed: Annotated[
        float, typer.Option(min=0.01, max=100.0, help="Times the speed of the recording.")
    ] = 1.0,
    begin: Begin = 0.0,
    end: End = None,
    channels: Annotated[str, typer.Option(help=ONLY)] = "",
    url: Annotated[
        str | None, typer.Option(help="LCM address; default: where tools listen to an arm.")
    ] = None,
    commands_as: Annotated[
        str, typer.Option(help="Send commands, too, under names that begin so: REPLAY_.")
    ] = "",
    with_commands: Annotated[
        bool, typer.Option("--with-commands", help="Send commands as they are; needs --url.")
    ] = False,
) -> None:
    """Send the messages of a log again, but no commands and not where an arm is running."""
    from limber.replay import replay as module

    options = module.ReplayOptions(
        speed, begin, _until(end), tuple(_names(channels)), url, commands_as, with_commands
    )
    module.replay(path, options, console)


def _until(end: float | None) -> float:
    return float("inf") if end is None else end


def _names(text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


@app.command(epilog="Example: limber plot out/demo-1 --what torque")
def plot(
    path: LogPath,
    what: Annotated[
        list[str] | None,
        typer.Option(
            help="overview, joint, cartesian, torque, spring, timing, bus or hand; default: all."
        ),
    ] = None,
    out: Out = None,
    compare: Annotated[
        Path | None, typer.Option(help="Another log, or folder of a run, drawn dotted beside it.")
    ] = None,
    run: Run = None,
) -> None:
    """Draw a log: one PNG a topic, and one interactive page that works offline."""
    from limber.plot import commands

    commands.plot(path, what or [], out, console, compare, run)
