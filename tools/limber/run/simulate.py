"""`limber sim`: what is about to be simulated, and how other programs join its buses."""

from pathlib import Path

from rich.console import Console

from limber.errors import InputError
from limber.live import network
from limber.paths import captured, program, robot_folder


def introduce(
    robot: str, bus_words: list[str], without_stand: bool, paced: bool, console: Console
) -> Path:
    """Says which motors are on which bus; returns the robot's folder."""
    folder = robot_folder(robot)
    network.require_multicast()
    command = [str(program("limber-can")), "nodes", str(folder), *bus_words]
    nodes = captured(command)
    if nodes.returncode != 0:
        raise InputError(nodes.stderr.strip().removeprefix("limber-can: "))
    print(nodes.stdout, end="")
    if without_stand:
        console.print("Nothing carries the arm: it falls until its drives hold it.")
    else:
        console.print(
            "The arm lies in its stand until every drive has been enabled for 0.3 s; --no-stand "
            "leaves it out."
        )
    console.print(
        "In lock step with limber-driver --paced until Ctrl-C."
        if paced
        else "In real time until Ctrl-C."
    )
    return folder
