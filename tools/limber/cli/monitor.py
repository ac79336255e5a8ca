"""`limber monitor`: the web page of a running arm or of a recorded run."""

from pathlib import Path
from typing import Annotated

import typer

from limber.cli.options import console
from limber.errors import InputError

app = typer.Typer()


@app.command(epilog="Example: limber monitor --control")
def monitor(
    log: Annotated[
        Path | None, typer.Argument(help="A log or the folder of a run; none: the running arm.")
    ] = None,
    robot: Annotated[
        str | None,
        typer.Option(help="The arm: name or folder. Default: the one that runs."),
    ] = None,
    control: Annotated[
        bool,
        typer.Option("--control", help="The page may move the arm, not only show and stop it."),
    ] = False,
    port: Annotated[
        int | None,
        typer.Option(
            min=1,
            max=65535,
            help="On this machine only.",
            show_default="8080; 8765 with --foxglove",
        ),
    ] = None,
    scenario: Annotated[
        Path | None, typer.Option(help="The running scenario, whose walls are shown.")
    ] = None,
    foxglove: Annotated[
        bool,
        typer.Option("--foxglove", help="For the Foxglove app instead of a page; read only."),
    ] = False,
) -> None:
    """Show a running arm, or a recorded run, in the browser: 3D, charts, faults, STOP."""
    from limber.live.network import require_multicast
    from limber.monitor import commands

    if foxglove and (log is not None or control or scenario is not None):
        raise InputError(
            "--foxglove shows a running arm, read only: no log (limber log convert --to mcap makes "
            "the file that Foxglove opens), no --control, no --scenario"
        )
    if log is not None:
        if control or scenario is not None:
            raise InputError("--control and --scenario are for a running arm: a log cannot move")
        commands.play(log, robot, port or commands.PORT, console)
        return
    require_multicast()
    if foxglove:
        from limber.monitor import foxglove_feed

        foxglove_feed.live(robot, port or foxglove_feed.PORT, console)
        return
    commands.live(robot, port or commands.PORT, control, scenario, console)
