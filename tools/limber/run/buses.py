"""Which CAN buses a run uses, and what that means for whoever stands beside the arm."""

from rich.console import Console

from limber.errors import InputError
from limber.model.can_address import KINDS
from limber.model.robot import Robot


def addresses(robot: Robot, overrides: tuple[str, ...]) -> dict[str, str]:
    """Name -> address, robot.yaml's or the one of --bus NAME=ADDR; refuses what can be neither."""
    chosen = dict(robot.buses)
    for text in overrides:
        name, _, address = text.partition("=")
        if name not in chosen:
            raise InputError(f"--bus {text}: the robot's buses are {', '.join(chosen)}")
        if not address.startswith(KINDS):
            raise InputError(
                f"--bus {text}: write {name}=socketcan:IFACE, {name}=virtual:NAME, "
                f"{name}=slcan:/dev/NAME or {name}=dmserial:/dev/NAME"
            )
        chosen[name] = address
    return chosen


def real(chosen: dict[str, str]) -> list[str]:
    """The addresses where a real arm may be."""
    return [address for address in chosen.values() if not address.startswith("virtual:")]


def warn_of_motion(chosen: dict[str, str], with_simulator: bool, console: Console) -> None:
    """Says what will move, wherever the address comes from."""
    places = real(chosen)
    if places:
        console.print(f"[yellow]whatever is on {' and '.join(places)} will move[/]")
    elif not with_simulator:
        console.print("[yellow]no simulator: whatever is on the bus will move[/]")
