"""`limber doctor`."""

from typing import Annotated

import typer

from limber.cli.options import console
from limber.errors import OK, RUN_FAILED

app = typer.Typer()


@app.command(epilog="Example: limber doctor my_arm")
def doctor(
    robot: Annotated[
        str | None, typer.Argument(help="Also its CAN interfaces: a name or folder.")
    ] = None,
) -> None:
    """Check network, buffers, real time, CAN and disk; each problem comes with a cure."""
    from limber.doctor import machine as module

    findings = module.examine(robot)
    colors = {"ok": "green", "warn": "yellow", "fail": "bold red"}
    for finding in findings:
        mark = f"[{colors[finding.level]}]{finding.level:4}[/]"
        console.print(f"{mark} {finding.subject}: {finding.text}", soft_wrap=True)
        if finding.cure:
            console.print(f"       cure: {finding.cure}", soft_wrap=True)
    failed = any(finding.level == "fail" for finding in findings)
    raise typer.Exit(RUN_FAILED if failed else OK)
