"""`limber sweep`: carries out a sweep from where it is, or replays a run of one."""

import fcntl
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from limber import tables
from limber.errors import OK, OUT_OF_TOLERANCE, InputError
from limber.model.scenario import load_scenario
from limber.paths import output_folder
from limber.run import commands as run_commands
from limber.run.commands import next_folder
from limber.run.options import RunOptions
from limber.run.processes import sigterm_as_interrupt
from limber.sweep.definition import FILE, Sweep, load, write_files
from limber.sweep.one_run import OUTCOMES, judge
from limber.sweep.table import WHOLE, Table
from limber.sweep.workers import client_of, rows

PICTURE = "sweep.png"


def begin(sweep: Sweep, out: Path | None, resume: bool) -> Path:
    """The folder of a new sweep, or with `resume` that of the same one."""
    folder = out or next_folder("sweep")
    if not (folder / FILE).exists():
        sweep.save(output_folder(folder))
    elif resume:
        sweep.refuse_another(folder)
    else:
        raise InputError(f"{folder} holds a sweep already: --resume goes on with it")
    return folder


def carry_out(folder: Path, on: str | None, processes: int | None, console: Console) -> None:
    """All runs that are not there yet. `on`: a scheduler's address; None: processes here."""
    sweep = load(folder)
    with open(folder / FILE, "rb") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise InputError(f"{folder}: another limber sweep works on it") from error
        table = Table(folder, sweep.vary)
        try:
            with sigterm_as_interrupt():
                _all_runs(sweep, table, on, processes, console)
        except BaseException:
            console.print(
                f"{len(table.done)} of {sweep.runs} runs are kept; go on with: "
                f"limber sweep {folder} --resume" + (f" --on {on}" if on else ""),
                soft_wrap=True,
            )
            raise
        table.finish()
    _conclude(sweep, table, folder, console)


def replay(folder: Path, run: int, out: Path | None, console: Console) -> int:
    """One run by `limber lab`, with log and pictures. Returns the exit code."""
    sweep = load(folder)
    if not 0 <= run < sweep.runs:
        raise InputError(f"--replay {run}: {folder} has the runs 0 to {sweep.runs - 1}")
    values = dict(sweep.each(set(range(sweep.runs)) - {run}))[run]
    out = out or next_folder(f"run_{run}", folder)
    with TemporaryDirectory(prefix="limber-sweep-") as sources:
        path = write_files(sweep.files_of(values), Path(sources))
        run_commands.lab(path, RunOptions(out), console)
        from limber.plot import commands as plot_commands

        plot_commands.plot(out, [], None, console)
        row = judge(out, load_scenario(path), sweep.overshoot)
    console.print(f"run {run}: {row['outcome']} {row['reason']}".rstrip(), soft_wrap=True)
    kept = [found for found in Table(folder, sweep.vary).rows().to_pylist() if found["run"] == run]
    differ = [key for found in kept for key, value in row.items() if found[key] != value]
    if differ:
        console.print(f"not as in the table: {', '.join(differ)}", soft_wrap=True)
    return OUT_OF_TOLERANCE if differ else OK


def _all_runs(
    sweep: Sweep, table: Table, on: str | None, processes: int | None, console: Console
) -> None:
    if table.done:
        console.print(f"{len(table.done)} of {sweep.runs} runs are there")
    if len(table.done) == sweep.runs:
        return
    columns = (BarColumn(), MofNCompleteColumn(), TextColumn("runs"), TimeRemainingColumn())
    tasks = (
        (run, values, sweep.files_of(values), sweep.overshoot, sweep.versions)
        for run, values in sweep.each(set(table.done))
    )
    with client_of(on, processes) as client, Progress(*columns, console=console) as progress:
        bar = progress.add_task("", total=sweep.runs, completed=len(table.done))
        for found in rows(client, tasks):
            table.add(found)
            progress.update(bar, completed=len(table.done))


def _conclude(sweep: Sweep, table: Table, folder: Path, console: Console) -> None:
    from limber.sweep import picture  # matplotlib takes a second to load

    found = table.rows()
    causes = Counter((row["outcome"], row["fault"] or row["reason"]) for row in found.to_pylist())
    shown = tables.table("<", ">runs", ">share", "~most often")
    for outcome in OUTCOMES:
        of = {cause: count for (name, cause), count in causes.items() if name == outcome}
        count, often = sum(of.values()), max(of, key=lambda cause: of[cause], default="")
        shown.add_row(outcome, f"{count}", f"{count / sweep.runs:.1%}", often)
    console.print(shown)
    picture.draw(sweep, found, folder / PICTURE)
    told = f"{folder / WHOLE}, {folder / PICTURE}; one again: limber sweep {folder} --replay 0"
    console.print(told, soft_wrap=True)
