"""Commands that break arms on purpose: `limber dev faults ...`."""

from typing import Annotated

import typer

from limber.cli.options import console
from limber.errors import OK, OUT_OF_TOLERANCE, InputError

app = typer.Typer(
    help="Inject faults and judge the reactions: the fault matrix.", no_args_is_help=True
)

Phases = Annotated[
    int, typer.Option(min=1, max=1000, help="Phases of the motion at which each fault begins.")
]


@app.command("list", epilog="Example: limber dev faults list")
def list_rows() -> None:
    """Show the rows of the matrix: what is injected, what is expected, how it is run."""
    from limber.tables import table
    from limber_qa.faults.matrix import read_matrix
    from limber_qa.faults.report import how_text, limit_text

    rows = table(">no.", "~fault", "~expected", ">limit", "~run as")
    for row in read_matrix():
        rows.add_row(str(row.number), row.fault, row.reaction, limit_text(row), how_text(row))
    console.print(rows)


@app.command(epilog="Example: limber dev faults run 36")
def run(
    row: Annotated[
        int | None, typer.Argument(min=1, help="One row by its number; all if there is none.")
    ] = None,
    phases: Phases = 20,
) -> None:
    """Run the lock-step faults of a row, or of all, each judged by the trace checker as well."""
    from limber_qa.faults.lockstep import run_fault
    from limber_qa.faults.matrix import read_matrix

    rows = read_matrix()
    if row is not None and row > len(rows):
        raise InputError(f"no row {row}; there are 1 to {len(rows)}")
    failed = 0
    for one in rows if row is None else [rows[row - 1]]:
        for fault in one.lock_step:
            result = run_fault(fault, phases)
            word = _word(result.passed, fault.known_failing)
            stop = "" if result.stop_ms is None else f", safe frame after {result.stop_ms:g} ms"
            reaction = "none" if result.cycles < 0 else f"{result.cycles} cycles"
            console.print(f"{one.number:2} {word} {fault.fault}: {reaction}{stop}")
            for problem in result.problems[:3]:
                console.print(f"      {problem}")
            failed += result.passed == bool(fault.known_failing)
        for test in one.tests if row is not None else ():
            console.print(f"{one.number:2} [dim]test[/] {test.test}")
    raise typer.Exit(OUT_OF_TOLERANCE if failed else OK)


def _word(passed: bool, known_failing: str) -> str:
    if known_failing:
        return "[bold red]MENDED[/]" if passed else "[yellow]known[/]"
    return "[green]ok[/]" if passed else "[bold red]FAILED[/]"


@app.command(epilog="Example: limber dev faults report")
def report(phases: Phases = 20) -> None:
    """Run the whole matrix in lock step and write qa/fault_matrix.md."""
    from limber_qa.faults import report as module

    path, failed = module.write(phases)
    console.print(f"{path}: written, {failed} rows not as expected")
    raise typer.Exit(OUT_OF_TOLERANCE if failed else OK)


@app.command(epilog="Example: limber dev faults bus")
def bus(
    fault: Annotated[
        str | None, typer.Argument(help="One fault by its name; all of the bus if there is none.")
    ] = None,
    phases: Phases = 3,
) -> None:
    """Inject faults into a simulated arm of each family of drives; show what the driver does."""
    from rich.table import Table

    from limber_qa import faults_doc

    table = Table(*faults_doc.HEAD, show_lines=True)
    for row in faults_doc.reactions(fault, phases):
        table.add_row(*faults_doc.cells(row))
    console.print(table)
