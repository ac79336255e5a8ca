"""Commands that check this machine and limber itself."""

from typing import Annotated

import typer

from limber.cli.options import console
from limber.dev import selftest
from limber.errors import OK, OUT_OF_TOLERANCE, RUN_FAILED

app = typer.Typer()


@app.command()
def doctor(
    robot: Annotated[
        str | None, typer.Argument(help="Also its CAN interfaces: a name or folder.")
    ] = None,
) -> None:
    """Check network, buffers, real time, CAN and disk; each problem comes with a cure."""
    from limber.dev import doctor as module

    findings = module.examine(robot)
    colors = {"ok": "green", "warn": "yellow", "fail": "bold red"}
    for finding in findings:
        mark = f"[{colors[finding.level]}]{finding.level:4}[/]"
        console.print(f"{mark} {finding.subject}: {finding.text}", soft_wrap=True)
        if finding.cure:
            console.print(f"       cure: {finding.cure}", soft_wrap=True)
    failed = any(finding.level == "fail" for finding in findings)
    raise typer.Exit(RUN_FAILED if failed else OK)


@app.command()
def test(
    part: Annotated[
        str | None,
        typer.Argument(help=f"One part: {', '.join(selftest.PARTS)}."),
    ] = None,
) -> None:
    """Run all the tests, as CI does."""
    passed = selftest.run(selftest.parts(part), console)
    raise typer.Exit(OK if passed else OUT_OF_TOLERANCE)


@app.command()
def docs() -> None:
    """Write the tables in the docs that come from programs: gains, and faults on the bus."""
    from limber.dev import faults_doc, gains_doc

    for table in (gains_doc.TABLE, faults_doc.TABLE):
        console.print(f"{table.path}: {'written' if table.write() else 'up to date'}")


@app.command()
def faults(
    fault: Annotated[
        str | None, typer.Argument(help="One fault by its name; all if there is none.")
    ] = None,
    phases: Annotated[
        int, typer.Option(min=1, max=100, help="Phases of the motion at which it begins.")
    ] = 3,
) -> None:
    """Inject faults into a simulated arm of each family of drives; show what the driver does."""
    from rich.table import Table

    from limber.dev import faults_doc

    table = Table(*faults_doc.HEAD, show_lines=True)
    for row in faults_doc.reactions(fault, phases):
        table.add_row(*faults_doc.cells(row))
    console.print(table)


@app.command()
def bench() -> None:
    """Build the benchmarks in release mode and run them, each beside a peer."""
    from limber.dev import bench as module

    raise typer.Exit(module.bench(console))
