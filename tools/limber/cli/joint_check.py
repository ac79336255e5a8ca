"""The check by hand before the first motion, and the whole first hour."""

from pathlib import Path
from typing import Annotated

import typer

from limber.cli import groups
from limber.cli.options import Bus, Private, Robot, console


@groups.identify.command("joints", epilog="Example: limber identify joints my_arm --json out.json")
def joints(
    robot: Robot,
    bus: Bus = None,
    no_sim: Annotated[
        bool, typer.Option("--no-sim", help="Another simulator is on the virtual bus.")
    ] = False,
    angle: Annotated[
        float, typer.Option(min=0.05, max=1.0, help="How far to turn a joint, rad.")
    ] = 0.2,
    length: Annotated[
        float, typer.Option(min=0.002, max=0.5, help="How far to move a prismatic joint, m.")
    ] = 0.02,
    json: Annotated[
        Path | None, typer.Option("--json", help="Write what was found to this file, too.")
    ] = None,
    private: Private = False,
) -> None:
    """Check by hand, with the drives off, that each joint is its own motor's and turns the right
    way.
    """
    from limber.joint_check import command
    from limber.joint_check.check import Amounts
    from limber.joint_check.drives import DriverOptions

    options = DriverOptions(tuple(bus or ()), not no_sim, private)
    raise typer.Exit(command.run(robot, options, Amounts(angle, length), json, console))


@groups.identify.command("first-hour", epilog="Example: limber first-hour my_arm")
def first_hour(
    robot: Robot,
    out: Annotated[
        Path | None, typer.Option("--out", help="Folder of the record; default out/first_hour/ARM.")
    ] = None,
    begin: Annotated[
        str | None,
        typer.Option("--from", help="Go back to: wire, motors, zero, directions, hold or push."),
    ] = None,
) -> None:
    """Lead from the wires to the first soft push: bus, motors, zeros, directions, HOLD with little
    torque, push. Goes on where it ended; writes what was found, to attach to a question.
    """
    from limber.first_hour import guide

    raise typer.Exit(guide.run(robot, out, begin, console))
