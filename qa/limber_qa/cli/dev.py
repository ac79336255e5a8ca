"""`limber dev ...`: commands that test limber itself."""

from pathlib import Path
from typing import Annotated

import typer

from limber.cli.options import console
from limber.errors import OK, OUT_OF_TOLERANCE
from limber.paths import ROOT
from limber_qa import selftest

app = typer.Typer(help="Test limber itself; only in a clone.", no_args_is_help=True)


@app.command(epilog="Example: limber dev test --quick")
def test(
    part: Annotated[
        str | None,
        typer.Argument(help=f"One part: {', '.join(selftest.PARTS)}."),
    ] = None,
    quick: Annotated[
        bool,
        typer.Option("--quick", help="Format, lint, and the unit tests of what changed."),
    ] = False,
) -> None:
    """Run all the tests, as CI does."""
    if quick:
        from limber_qa import quick as module

        raise typer.Exit(OK if module.run() else OUT_OF_TOLERANCE)
    passed = selftest.run(selftest.parts(part), console)
    raise typer.Exit(OK if passed else OUT_OF_TOLERANCE)


@app.command(epilog="Example: limber dev docs")
def docs() -> None:
    """Write the parts of the docs that come from programs: problems, gains, keys of robot.yaml,
    faults on the bus, fuzzing, Python.

    The fault matrix takes minutes: `limber dev faults report` writes it.
    """
    from limber_qa import (
        faults_doc,
        fuzz,
        gains_doc,
        python_doc,
        robot_keys_doc,
        troubleshooting_doc,
    )

    written = (troubleshooting_doc, gains_doc, robot_keys_doc, faults_doc, fuzz, python_doc)
    for table in (module.TABLE for module in written):
        console.print(f"{table.path}: {'written' if table.write() else 'up to date'}")


@app.command(epilog="Example: limber dev mutation controller/watches/load_watch.cc")
def mutation(
    where: Annotated[
        list[str] | None,
        typer.Argument(help="Areas of tests/mutation/targets.yaml, or files; all if none."),
    ] = None,
    sample: Annotated[
        int | None, typer.Option(min=1, help="So many of the mutants, drawn at random.")
    ] = None,
    seed: Annotated[int, typer.Option(help="Of what is drawn, and of the order.")] = 1,
    seconds: Annotated[
        float | None, typer.Option(min=0, help="No mutant is begun later; the build not counted.")
    ] = None,
) -> None:
    """Put faults into the code, one at a time, and see which ones no test notices."""
    from limber_qa.mutation import campaign, report

    result = campaign.run(where or [], sample, seed, seconds, console.print)
    report.show(result, console)
    raise typer.Exit(OK if result.passed() else OUT_OF_TOLERANCE)


@app.command(epilog="Example: limber dev coverage")
def coverage(
    write: Annotated[bool, typer.Option("--write", help="Keep the figures of this run.")] = False,
) -> None:
    """Count which lines and branches of gate, tables and supervisor their unit tests reach."""
    from limber.tables import table
    from limber_qa import coverage as module

    figures = module.measure()
    shown = table("<file", ">lines %", ">branches %", "~")
    for each in figures:
        note = f"fell from {each.before}" if each.fell else "rose" if each.rose else ""
        shown.add_row(each.file, f"{each.lines:.1f}", f"{each.branches:.1f}", note)
    console.print(shown)
    if write:
        module.write(figures)
    elif any(each.rose for each in figures):
        console.print("some rose: limber dev coverage --write keeps them")
    raise typer.Exit(OUT_OF_TOLERANCE if not write and any(e.fell for e in figures) else OK)


@app.command(epilog="Example: limber dev fuzz --minutes 10")
def fuzz(
    target: Annotated[list[str] | None, typer.Argument(help="All if there is none.")] = None,
    inputs: Annotated[int, typer.Option(min=0, help="Inputs a target.")] = 0,
    minutes: Annotated[float, typer.Option(min=0, help="Minutes a target.")] = 0,
    seed: Annotated[int, typer.Option(min=1, help="Of what libFuzzer makes.")] = 1,
) -> None:
    """Feed garbled bytes to everything that reads some, by libFuzzer: kept inputs, and new ones
    made of them; without --inputs and --minutes as many as limber test tries."""
    from limber_qa import fuzz as module

    passed = module.run(module.targets(target or []), console, inputs, minutes, seed)
    raise typer.Exit(OK if passed else OUT_OF_TOLERANCE)


@app.command(epilog="Example: limber dev tidy sim/joints/spring.cc")
def tidy(
    source: Annotated[list[str] | None, typer.Argument(help="Else: what changed.")] = None,
    everything: Annotated[bool, typer.Option("--all", help="Every source: an hour.")] = False,
) -> None:
    """Read C++ sources by clang-tidy."""
    from limber_qa import tidy as module

    passed = module.run(source or [], everything, console)
    raise typer.Exit(OK if passed else OUT_OF_TOLERANCE)


@app.command(epilog="Example: limber dev soak --hours 24")
def soak(
    robot: Annotated[str, typer.Option(help="The arm: name or folder.")] = "planar2r",
    hours: Annotated[float, typer.Option(min=1e-4, help="Of arm time.")] = 24,
    seconds: Annotated[float, typer.Option(min=0, help="At most so much wall time; 0: any.")] = 0,
    seed: Annotated[int, typer.Option(min=0, help="Of everything random.")] = 1,
    realtime: Annotated[
        bool, typer.Option("--realtime", help="The real processes, in real time.")
    ] = False,
    any_request: Annotated[
        bool,
        typer.Option("--any-request", help="Any law, gain and goal that is accepted; no pushes."),
    ] = False,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for the report.")] = None,
) -> None:
    """Use a simulated arm for hours, at random and with injected faults; nothing may happen without
    a cause. With --realtime: the real processes undisturbed, and how late their cycles start."""
    from limber_qa import realtime_soak
    from limber_qa import soak as module

    folder = out or ROOT / "out" / "soak"
    if realtime:
        raise typer.Exit(realtime_soak.run(robot, hours, seed, folder, console))
    raise typer.Exit(module.run(robot, hours, seconds, seed, any_request, folder, console))


@app.command(epilog="Example: limber dev bench")
def bench(
    as_json: Annotated[bool, typer.Option("--json", help="Figures as JSON.")] = False,
    long: Annotated[
        bool, typer.Option("--long", help="Ten million cycles watched, the recorder for a minute.")
    ] = False,
) -> None:
    """Build the benchmarks in release mode and run them, each beside a peer."""
    from limber_qa import bench as module

    raise typer.Exit(module.bench(console, as_json, long))


@app.command(epilog="Example: limber dev release --out ../release")
def release(
    out: Annotated[Path, typer.Option("--out", help="An empty folder.")],
    debs: Annotated[bool, typer.Option(help="Debian packages: as root, with mmdebstrap.")] = True,
    foreign: Annotated[
        bool, typer.Option(help="The wheel for aarch64: with g++-aarch64-linux-gnu, mmdebstrap.")
    ] = True,
) -> None:
    """Make what is handed out: wheels, Debian packages, sources, pages, licences, checksums."""
    from limber_qa import release as module

    module.release(out, console, debs, foreign)


@app.command(epilog="Example: limber dev site --out out/site")
def site(
    out: Annotated[Path, typer.Option("--out", help="Folder of the pages.")],
) -> None:
    """Write the pages as a site that works without a network."""
    from limber_qa import site as module

    console.print(f"{module.build(out) / 'index.html'}", soft_wrap=True)
