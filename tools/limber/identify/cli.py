"""`limber identify ...`"""

import sys
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

app = typer.Typer(help="Find out about the arm from its runs.", no_args_is_help=True)
console = Console(width=None if sys.stdout.isatty() else 120)

Runs = Annotated[list[Path], typer.Argument(help="Logs, or folders of runs.")]
Robot = Annotated[
    str | None,
    typer.Option(help="The arm's name or folder; default: the copy beside the first log."),
]
Out = Annotated[
    Path | None, typer.Option("--out", help="Folder for the results; default: beside the log.")
]


@app.command("motion")
def motion(
    robot: Annotated[str, typer.Option(help="The arm's name or folder.")] = "openarm",
    out: Annotated[Path, typer.Option("--out", help="Scenario file to write.")] = Path(
        "identify.yaml"
    ),
    spread: Annotated[
        float, typer.Option(min=0.05, max=3.0, help="How far from home joints go, rad or m.")
    ] = 0.6,
    poses: Annotated[int, typer.Option(min=2, max=50, help="Poses of the tour.")] = 5,
    seed: Annotated[int, typer.Option(help="Another one: another tour.")] = 1,
) -> None:
    """Write the scenario whose log the other commands want: a tour of poses, slow and fast."""
    from limber.identify import report

    report.plan(robot, spread, poses, seed, out, console)


@app.command("torque-constant")
def torque_constant(runs: Runs, robot: Robot = None, out: Out = None) -> None:
    """True torque of each motor for what its drive believes, from slow motions up and down."""
    from limber.identify import report

    report.run("torque-constant", runs, robot, out, console)


@app.command("friction")
def friction(runs: Runs, robot: Robot = None, out: Out = None) -> None:
    """Coulomb, viscous and breakaway friction, from motions in both directions, slow and fast."""
    from limber.identify import report

    report.run("friction", runs, robot, out, console)


@app.command("stiffness")
def stiffness(runs: Runs, robot: Robot = None, out: Out = None) -> None:
    """Stiffness of the joints' springs, from deflection over torque."""
    from limber.identify import report

    report.run("stiffness", runs, robot, out, console)


@app.command("gravity")
def gravity(runs: Runs, robot: Robot = None, out: Out = None) -> None:
    """Masses and centres of the links as far as gravity shows them; proposes a URDF."""
    from limber.identify import report

    report.run_gravity(runs, robot, out, console)


@app.command("payload")
def payload(
    runs: Runs,
    robot: Robot = None,
    offsets: Annotated[
        bool, typer.Option("--offsets", help="Estimate constant joint torque offsets as well.")
    ] = False,
    out: Out = None,
) -> None:
    """Mass and centre of mass of what the tip carries, from the torques of static poses."""
    from limber.identify import payload as module

    module.run(runs, robot, offsets, out, console)
