"""`limber sweep`: many runs with other values."""

from pathlib import Path
from typing import Annotated

import typer

from limber.cli import groups
from limber.cli.options import Out, console
from limber.errors import InputError


@groups.identify.command(
    "sweep", epilog="Example: limber sweep push --vary gains.K_x=100..2000 --runs 200"
)
def sweep(
    what: Annotated[Path, typer.Argument(help="Scenario file, or a sweep's folder.")],
    vary: Annotated[
        list[str] | None, typer.Option(help="KEY=LOW..HIGH, KEY=LOW..HIGH:log or KEY=A,B,C.")
    ] = None,
    runs: Annotated[int, typer.Option(min=1, max=1_000_000, help="How many.")] = 100,
    method: Annotated[str, typer.Option(help="lhs, grid or monte-carlo.")] = "lhs",
    seed: Annotated[int, typer.Option(min=0, help="Of the values, and of each run's seed.")] = 1,
    overshoot: Annotated[float, typer.Option(min=0.0, help="Most of a run that holds.")] = 0.2,
    on: Annotated[str | None, typer.Option(help="A Dask scheduler: tcp://HOST:8786.")] = None,
    processes: Annotated[
        int | None, typer.Option(min=1, help="Here; default: a core each.")
    ] = None,
    out: Out = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on after whatever end.")] = False,
    replay: Annotated[int | None, typer.Option(help="A run again, with log and pictures.")] = None,
) -> None:
    """Run a scenario many times with other values; draw the share of runs that hold."""
    from limber.sweep import commands
    from limber.sweep.definition import define

    if replay is not None:
        raise typer.Exit(commands.replay(what, replay, out, console))
    if not what.is_dir():
        sweep = define(what, vary or [], method, runs, seed, overshoot)
        what = commands.begin(sweep, out, resume)
    elif not resume:
        raise InputError(f"{what} is a folder: --resume goes on with its sweep")
    commands.carry_out(what, on, processes, console)
