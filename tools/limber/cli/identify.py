"""Commands that identify the arm from its runs: `limber identify ...`."""

from pathlib import Path
from typing import Annotated

import typer

from limber.cli import groups
from limber.cli.options import console

app = groups.identify

Runs = Annotated[list[Path], typer.Argument(help="Logs, or folders of runs.")]
RunsOrCsv = Annotated[
    list[Path] | None, typer.Argument(help="Logs, or folders of runs; none with --csv.")
]
Csv = Annotated[
    Path | None,
    typer.Option("--csv", help="Any recording, one line a sample, with --columns and --robot."),
]
Columns = Annotated[
    Path | None, typer.Option("--columns", help="YAML file that says what the CSV's columns are.")
]
WeightsKnown = Annotated[
    float | None,
    typer.Option(
        "--weights-known",
        min=0.001,
        max=1.0,
        help="Share to which the URDF's masses are known, 0.02 if weighed; default 0.3, as of CAD.",
    ),
]
Robot = Annotated[
    str | None,
    typer.Option(help="The arm's name or folder; default: the copy beside the first log."),
]
Run = Annotated[
    int | None,
    typer.Option("--run", min=1, help="Which, of logs that hold several runs; default: all."),
]
Out = Annotated[
    Path | None, typer.Option("--out", help="Folder for the results; default: beside the log.")
]


@app.command("motion", epilog="Example: limber identify motion --robot my_arm --out tour.yaml")
def motion(
    robot: Annotated[str, typer.Option(help="The arm's name or folder.")] = "openarm",
    out: Annotated[Path, typer.Option("--out", help="Scenario file to write.")] = Path(
        "identify.yaml"
    ),
    spread: Annotated[
        float, typer.Option(min=0.05, max=3.0, help="How far from home joints go, rad or m.")
    ] = 0.6,
    poses: Annotated[int, typer.Option(min=2, max=50, help="Poses of the tour.")] = 5,
    seed: Annotated[int, typer.Option(help="Selects the tour.")] = 1,
) -> None:
    """Write a scenario whose log serves the other commands: a tour of poses, slow and fast."""
    from limber.identify import commands

    commands.plan(robot, spread, poses, seed, out, console)


def _from_motion(kind: str, what: str, on_weights: bool, example: str) -> None:
    """The commands that read a motion; `on_weights` rest on the masses of the URDF."""

    def identify(
        runs: RunsOrCsv = None,
        robot: Robot = None,
        csv: Csv = None,
        columns: Columns = None,
        weights_known: WeightsKnown = None,
        run: Run = None,
        out: Out = None,
    ) -> None:
        from limber.identify import commands

        source = commands.Source(runs or [], robot, csv, columns, run)
        commands.run(kind, source, weights_known, out, console)

    def of_itself(
        runs: RunsOrCsv = None,
        robot: Robot = None,
        csv: Csv = None,
        columns: Columns = None,
        run: Run = None,
        out: Out = None,
    ) -> None:
        identify(runs, robot, csv, columns, None, run, out)

    epilog = f"Example: limber identify {kind} {example}"
    app.command(kind, help=what, epilog=epilog)(identify if on_weights else of_itself)


for kind, on_weights, example, what in (
    (
        "torque-constant",
        True,
        "out/tour",
        "Identify true over assumed motor torque, from slow motions up and down.",
    ),
    (
        "friction",
        True,
        "out/tour",
        "Identify Coulomb, viscous and breakaway friction, from slow and fast motions both ways.",
    ),
    (
        "stiffness",
        False,
        "out/tour",
        "Identify the stiffness of the joints' springs, from deflection over torque.",
    ),
    (
        "gravity",
        False,
        "out/tour",
        "Identify masses and centres of the links as far as gravity shows them; propose a URDF.",
    ),
    (
        "arm",
        True,
        "tour.yaml --out out/identified",
        "Identify weights, constants, friction and springs in one go; of a scenario, in the lab.",
    ),
):
    _from_motion(kind, what, on_weights, example)


@app.command("payload", epilog="Example: limber identify payload out/with_tool")
def payload(
    runs: Runs,
    robot: Robot = None,
    offsets: Annotated[
        bool, typer.Option("--offsets", help="Estimate constant joint torque offsets as well.")
    ] = False,
    out: Out = None,
) -> None:
    """Identify mass and centre of mass of the payload at the tip, from static poses."""
    from limber.identify import payload as module

    module.run(runs, robot, offsets, out, console)
