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
    """Write the tables of gains in scenarios/README.md from what the controller lists."""
    from limber.dev import gains_doc

    changed = gains_doc.write()
    console.print(f"{gains_doc.README}: {'written' if changed else 'up to date'}")


@app.command()
def bench() -> None:
    """Build the benchmarks in release mode and run them, each beside a peer."""
    from limber.dev import bench as module

    raise typer.Exit(module.bench(console))
