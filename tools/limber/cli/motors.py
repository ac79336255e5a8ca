"""Commands for single motors, before they are an arm: `limber can motors ...`, or without `can`."""

from typing import Annotated

import typer

from limber.cli.options import become

app = typer.Typer(
    help="Find the motors on a bus; show what is stored in them; set number and zero.",
    no_args_is_help=True,
)

BusName = Annotated[str, typer.Argument(help="can0, or virtual:NAME.")]
Motor = Annotated[str, typer.Argument(help="FAMILY:NUMBER, as scan prints it.")]
Fd = Annotated[bool, typer.Option("--fd", help="The bus is CAN-FD, which moteus motors need.")]
NUMBERS = {"min": 1, "max": 127}


@app.command(epilog="Example: limber can motors scan can0 --fd")
def scan(bus: BusName, fd: Fd = False) -> None:
    """List the motors of every family that answer. Nothing is commanded or written."""
    _become("scan", bus, fd)


@app.command(epilog="Example: limber can motors show can0 damiao_mit:3")
def show(bus: BusName, motor: Motor, fd: Fd = False) -> None:
    """Show what a motor has stored, and what it measures."""
    _become("show", bus, fd, motor)


@app.command("set-id", epilog="Example: limber can motors set-id can0 robstride:127 3")
def set_id(
    bus: BusName,
    motor: Motor,
    number: Annotated[int, typer.Argument(help="The new number.", **NUMBERS)],
    fd: Fd = False,
) -> None:
    """Give a motor another number, stored and read back."""
    _become("set-id", bus, fd, motor, str(number))


@app.command(epilog="Example: limber can motors zero can0 damiao_mit:3")
def zero(bus: BusName, motor: Motor, fd: Fd = False) -> None:
    """Make where a motor is its zero, stored and read back."""
    _become("zero", bus, fd, motor)


def _become(command: str, bus: str, fd: bool, *words: str) -> None:
    address = bus if ":" in bus else f"socketcan:{bus}"
    become("limber-motors", command, address, *words, *(["--fd"] if fd else []))
