"""`limber lecture experiment`: list them, run them, write the report."""

import os
from pathlib import Path
from typing import Annotated

import typer

from limber import tables
from limber.cli.options import console
from limber.errors import OK, OUT_OF_TOLERANCE

app = typer.Typer(
    help="Measure what the lecture claims and compare with the formulas.", no_args_is_help=True
)
PROCESSORS = min(len(os.sched_getaffinity(0)), 64)
DEFAULT_OUT = Path("out") / "experiments"
Root = Annotated[Path | None, typer.Option("--root", help="Folder with other experiments.")]
Out = Annotated[Path, typer.Option("--out", help="Folder for the results.")]


@app.command("list", epilog="Example: limber lecture experiment list")
def list_experiments(root: Root = None) -> None:
    """All experiments: what each claims and on what it is measured."""
    from limber_lecture.catalog import catalog

    table = tables.table("<", "<section", "~claim", "~measured on", "<")
    for experiment in catalog(root):
        fast = "fast" if experiment.fast else ""
        table.add_row(experiment.id, experiment.section, experiment.claim, experiment.plant, fast)
    console.print(table)


@app.command("run", epilog="Example: limber lecture experiment run E12")
def run_experiments(
    which: Annotated[list[str], typer.Argument(help="all, or numbers such as E04 E12.")],
    out: Out = DEFAULT_OUT,
    fast: Annotated[bool, typer.Option("--fast", help="Only those that take seconds.")] = False,
    jobs: Annotated[
        int, typer.Option(min=1, max=64, help="Number of experiments at a time.")
    ] = PROCESSORS,
    check_trace: Annotated[
        bool,
        typer.Option("--check-trace", "--referee", help="Judge the CAN frames, too."),
    ] = False,
    root: Root = None,
) -> None:
    """Run experiments; each leaves result.json and picture.png. Exit code 1 if a check fails."""
    from limber.errors import InputError
    from limber.paths import output_folder
    from limber_lecture.batch import run_many
    from limber_lecture.catalog import catalog, choose
    from limber_lecture.context import CHECK_TRACE
    from limber_lecture.run_one import run_one, summary

    chosen = [item for item in choose(which, catalog(root)) if item.fast or not fast]
    if not chosen:
        raise InputError("--fast leaves none of them; omit it")
    output_folder(out)
    if check_trace:
        os.environ[CHECK_TRACE] = "1"
    if len(chosen) > 1:
        raise typer.Exit(run_many(chosen, out, jobs, console))
    checks = run_one(chosen[0], out, console)
    rows = [check.as_json() for check in checks]
    console.print(summary(rows, f"{chosen[0].id}: {chosen[0].title}"))
    console.print(f"results: {out / chosen[0].id}", soft_wrap=True)
    raise typer.Exit(OK if all(check.passed for check in checks) else OUT_OF_TOLERANCE)


@app.command("report", epilog="Example: limber lecture experiment report")
def write_report(
    out: Out = DEFAULT_OUT,
    root: Root = None,
) -> None:
    """One page, report.html, from the results in the folder: every claim, verdict, picture."""
    from limber_lecture.report import write

    page = write(out, root)
    console.print(f"wrote {page}", soft_wrap=True)
