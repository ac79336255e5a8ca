"""What several groups of commands share: the console, options, and starting a C++ program."""

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer
from rich.console import Console

from limber.paths import program

if TYPE_CHECKING:
    from limber.log.events import Names

# A pipe or a file has no width of its own.
console = Console(width=None if sys.stdout.isatty() else 120, highlight=False)

Out = Annotated[Path | None, typer.Option("--out", help="Folder for the results.")]
LogPath = Annotated[Path, typer.Argument(help="A log, or the folder of a run.")]
ScenarioPath = Annotated[Path, typer.Argument(help="Scenario file (.yaml).")]
Robot = Annotated[str, typer.Argument(help="The arm: name or folder.")]
Bus = Annotated[
    list[str] | None, typer.Option(metavar="NAME=ADDR", help="Overrides a bus address.")
]
Private = Annotated[
    bool, typer.Option("--private", help="Use a private network, invisible to other terminals.")
]


def become(name: str, *arguments: str) -> NoReturn:
    """Replaces this process by a C++ program."""
    path = str(program(name))
    os.execv(path, [path, *arguments])


def bus_words(buses: list[str] | None) -> list[str]:
    """As the C++ programs take them."""
    return [word for bus in buses or () for word in ("--bus", bus)]


def names_of(robot: str | None) -> "Names":
    """Of the laws, and of a robot's joints; None: they are numbered."""
    from limber.log.events import Names
    from limber.model.gains_table import law_names
    from limber.model.robot import load_robot

    return Names([] if robot is None else load_robot(robot).joint_names, law_names())
