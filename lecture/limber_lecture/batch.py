"""Runs many experiments, one a processor; each has a process, so a failure stops no other.

The processes are forks of one that has imported what all of them need.
"""

import json
import multiprocessing
import os
import sys
import time
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from multiprocessing.context import ForkServerContext
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from limber import tables
from limber.errors import OK, OUT_OF_TOLERANCE, RUN_FAILED, LimberError
from limber.paths import output_folder
from limber_lecture.catalog import Experiment, load
from limber_lecture.run_one import RESULT, numbers, run_one

# Linear algebra must not take the processors of the others.
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


@dataclass(frozen=True)
class Outcome:
    """`rows` as in result.json; none, and the reason in `error`, if the experiment failed."""

    experiment: Experiment
    rows: list[dict]
    error: str
    seconds: float

    @property
    def passed(self) -> bool:
        return bool(self.rows) and all(row["pass"] for row in self.rows)


def run_many(experiments: list[Experiment], out: Path, jobs: int, console: Console) -> int:
    """Returns the exit code: 0 if all checks of all experiments pass."""
    outcomes = sorted(_outcomes(experiments, out, jobs, console), key=lambda o: o.experiment.id)
    console.print(summary(outcomes))
    console.print(f"results: {out}", soft_wrap=True)
    if any(outcome.error for outcome in outcomes):
        return RUN_FAILED
    return OK if all(outcome.passed for outcome in outcomes) else OUT_OF_TOLERANCE


def _outcomes(
    experiments: list[Experiment], out: Path, jobs: int, console: Console
) -> list[Outcome]:
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn())
    done = []
    os.environ.update(ONE_THREAD)
    processes = multiprocessing.get_context("forkserver")
    processes.set_forkserver_preload(["limber_lecture.context"])
    slow_first = sorted(experiments, key=lambda experiment: experiment.fast)
    with (
        ThreadPoolExecutor(jobs) as pool,
        Progress(*columns, TimeElapsedColumn(), console=console) as progress,
    ):
        task = progress.add_task("experiments", total=len(experiments))
        futures = [
            pool.submit(_in_process, experiment, out, processes) for experiment in slow_first
        ]
        try:
            for future in as_completed(futures):
                outcome = future.result()
                done.append(outcome)
                progress.update(task, advance=1)
                verdict = "ok" if outcome.passed else outcome.error or "NO"
                line = f"{outcome.experiment.id} {outcome.seconds:6.1f} s  {verdict}"
                progress.console.print(line, soft_wrap=True)
        except KeyboardInterrupt:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return done


def _in_process(experiment: Experiment, out: Path, processes: ForkServerContext) -> Outcome:
    folder = output_folder(out / experiment.id)
    log = folder / "run.txt"
    start = time.monotonic()
    process = processes.Process(target=_work, args=(experiment.folder, out, log))
    process.start()
    process.join()
    seconds = time.monotonic() - start
    if process.exitcode == OK:
        rows = json.loads((folder / RESULT).read_text(encoding="utf-8"))
        return Outcome(experiment, rows, "", seconds)
    lines = log.read_text(encoding="utf-8").strip().splitlines() if log.exists() else []
    ended = f"ended with code {process.exitcode}"
    return Outcome(experiment, [], lines[-1] if lines else ended, seconds)


def _work(folder: Path, out: Path, log: Path) -> None:
    """One experiment; what it prints goes to the log."""
    with open(log, "w", encoding="utf-8") as file:
        for stream in (sys.stdout, sys.stderr):
            os.dup2(file.fileno(), stream.fileno())
    try:
        run_one(load(folder), out, Console())
    except LimberError as error:
        print(error, flush=True)
        sys.exit(RUN_FAILED)


def summary(outcomes: list[Outcome]) -> Table:
    """One line an experiment, with the first check that fails, else the first of all."""
    columns = ("<", "~claim", "<predicted", "<measured", "<checks", "<")
    drawn = tables.table(*columns, title="Experiments")
    for outcome in outcomes:
        good = sum(row["pass"] for row in outcome.rows)
        shown = next((row for row in outcome.rows if not row["pass"]), None)
        shown = shown or (outcome.rows[0] if outcome.rows else None)
        checks = f"{good} of {len(outcome.rows)}"
        claim = outcome.experiment.id, outcome.experiment.title
        drawn.add_row(
            *claim, *(numbers(shown) if shown else ("", "")), checks, tables.verdict(outcome.passed)
        )
    return drawn
