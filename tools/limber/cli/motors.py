"""Commands for single motors, before they are an arm: `limber motors ...`."""

from pathlib import Path
from typing import Annotated

import typer

from limber.cli.options import become
from limber.model.can_address import full_address

app = typer.Typer(
    help="Find the motors on a bus; show, keep and set what is stored in them.",
    no_args_is_help=True,
)

BusName = Annotated[str, typer.Argument(help="can0, or virtual:NAME.")]
Motor = Annotated[str, typer.Argument(help="FAMILY:NUMBER, as scan prints it.")]
Fd = Annotated[bool, typer.Option("--fd", help="The bus is CAN-FD, which moteus motors need.")]
NUMBERS = {"min": 1, "max": 127}


@app.command(epilog="Example: limber motors scan can0 --fd")
def scan(bus: BusName, fd: Fd = False) -> None:
    """List the motors of every family that answer. Nothing is written or switched on."""
    _become("scan", bus, fd)


@app.command(epilog="Example: limber motors show can0 damiao_mit:3")
def show(bus: BusName, motor: Motor, fd: Fd = False) -> None:
    """Show what a motor has stored, and what it measures."""
    _become("show", bus, fd, motor)


@app.command("set-id", epilog="Example: limber motors set-id can0 robstride:127 3")
def set_id(
    bus: BusName,
    motor: Motor,
    number: Annotated[int, typer.Argument(help="The new number.", **NUMBERS)],
    fd: Fd = False,
) -> None:
    """Give a motor another number, stored and read back."""
    _become("set-id", bus, fd, motor, str(number))


@app.command(epilog="Example: limber motors zero can0 damiao_mit:3")
def zero(bus: BusName, motor: Motor, fd: Fd = False) -> None:
    """Make where a motor is its zero, stored and read back."""
    _become("zero", bus, fd, motor)


@app.command("set-baud", epilog="Example: limber motors set-baud can0 damiao_mit:3 5000000 --fd")
def set_baud(
    bus: BusName,
    motor: Motor,
    rate: Annotated[int, typer.Argument(help="bit/s; of the data on a CAN-FD bus.")],
    fd: Fd = False,
) -> None:
    """Give a motor another bit rate. It is silent at its old one then."""
    _become("set-baud", bus, fd, motor, str(rate))


@app.command(epilog="Example: limber motors watch can0 damiao_mit:1 damiao_mit:2")
def watch(
    bus: BusName,
    motors: Annotated[
        list[str] | None, typer.Argument(help="FAMILY:NUMBER; none: all that answer.")
    ] = None,
    fd: Fd = False,
) -> None:
    """Show what motors measure that are off, several times a second, until Ctrl-C."""
    _become("watch", bus, fd, *(motors or []))


@app.command(epilog="Example: limber motors dump can0 --out motors.yaml")
def dump(
    buses: Annotated[list[str], typer.Argument(help="can0, or virtual:NAME; any number.")],
    out: Annotated[Path | None, typer.Option("--out", help="File for it.")] = None,
    fd: Fd = False,
) -> None:
    """Print the settings of all motors on these buses as YAML, for version control."""
    file = [] if out is None else ["--out", str(out)]
    become("limber-motors", "dump", *map(full_address, buses), *file, *(["--fd"] if fd else []))


@app.command(epilog="Example: limber motors restore motors.yaml")
def restore(file: Annotated[Path, typer.Argument(help="As dump wrote it.")]) -> None:
    """Show how motors differ from a dump and write its settings: never number, zero or bit rate."""
    become("limber-motors", "restore", str(file))


def _become(command: str, bus: str, fd: bool, *words: str) -> None:
    become("limber-motors", command, full_address(bus), *words, *(["--fd"] if fd else []))
