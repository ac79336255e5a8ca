"""Commands that read black boxes: `limber log black-box ...`."""

from pathlib import Path
from typing import Annotated

import typer

from limber.cli.options import Out, console

app = typer.Typer(help="What the processes kept around a fault.", no_args_is_help=True)


@app.command("list", epilog="Example: limber log black-box list")
def list_() -> None:
    """List the black boxes that are kept, the oldest first."""
    from limber.black_box import commands

    commands.show_all(console)


@app.command(epilog="Example: limber log black-box show")
def show(
    box: Annotated[Path | None, typer.Argument(help="A .box file; default: the newest.")] = None,
    out: Out = None,
) -> None:
    """Report a black box: events in order, pictures, one log of all processes, and a scenario."""
    from limber.black_box import commands

    commands.show(box, out, console)


@app.command(epilog="Example: limber log black-box reproduce out/push")
def reproduce(
    log: Annotated[Path, typer.Argument(help="A log, or the folder of a run or a black box.")],
    robot: Annotated[
        str | None, typer.Option(help="Its robot; default: the one beside the log.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="The scenario; default: reproduce.yaml beside the log.")
    ] = None,
) -> None:
    """Write a scenario that does in simulation what a log shows, up to its first fault."""
    from limber.black_box import commands

    commands.reproduce(log, robot, out, console)
