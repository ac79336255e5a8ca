"""`limber doctor`."""

from pathlib import Path
from typing import Annotated

import typer

from limber.cli.options import Bus, console
from limber.errors import OK, RUN_FAILED, InputError

app = typer.Typer()


@app.command(epilog="Example: limber doctor my_arm")
def doctor(
    robot: Annotated[
        str | None, typer.Argument(help="Also its CAN interfaces: a name or folder.")
    ] = None,
    write_udev: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", help="Write files that name its adapters for good and bring them up."
        ),
    ] = None,
    bus: Bus = None,
) -> None:
    """Check network, buffers, real time, CAN and disk; each problem comes with a cure."""
    from limber.doctor import machine as module

    if write_udev is not None:
        return _write_udev(robot, tuple(bus or ()), write_udev)
    findings = module.examine(robot)
    colors = {"ok": "green", "warn": "yellow", "fail": "bold red"}
    for finding in findings:
        mark = f"[{colors[finding.level]}]{finding.level:4}[/]"
        console.print(f"{mark} {finding.subject}: {finding.text}", soft_wrap=True)
        if finding.cure:
            console.print(f"       cure: {finding.cure}", soft_wrap=True)
    failed = any(finding.level == "fail" for finding in findings)
    raise typer.Exit(RUN_FAILED if failed else OK)


def _write_udev(robot: str | None, buses: tuple[str, ...], out: Path) -> None:
    from limber.doctor import adapter_files
    from limber.model.robot import load_robot
    from limber.run.buses import addresses

    if robot is None:
        raise InputError("--write-udev needs the arm whose buses the adapters are: name or folder")
    adapter_files.write(robot, addresses(load_robot(robot), buses), out, console)
