"""`limber log black-box`: lists black boxes, and makes one report of those of one event: the
events in order, one log, pictures, and a scenario that does the same in simulation.
"""

import os
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

from rich.console import Console

from limber import tables
from limber.black_box.boxes import Box, folder, kept_boxes, read, together, write_log
from limber.black_box.reproduce import reproduction
from limber.errors import InputError
from limber.log.commands import show_events
from limber.log.events import Names
from limber.log.reader import Log, log_file
from limber.model.gains_table import law_names
from limber.model.robot import Robot, keep_description, load_robot, robot_beside
from limber.output import write_again
from limber.paths import existing_file, run_folder
from limber.plot.commands import plot

KILLED = "killed"


def dated(box: Box) -> Box:
    """A process that was killed could not date its box, the next of its name did: the last record
    counts.
    """
    if box.code != KILLED:
        return box
    records = read(box.path)
    if not records:
        return box
    return replace(box, when=datetime.fromtimestamp(records[-1].time_us * 1e-6, UTC))


def show_all(console: Console) -> None:
    found = sorted(map(dated, kept_boxes()), key=lambda box: box.when)
    if not found:
        console.print(f"no black box is kept in {folder()}", soft_wrap=True)
        return
    table = tables.table("<when (UTC)", "<robot", "<kept by", "<because of", "~file")
    for box in found:
        when = f"{box.when:%Y-%m-%d %H:%M:%S}"
        table.add_row(when, box.robot, box.program, box.code, box.path.name)
    console.print(table)
    console.print(f"in {folder()}; `limber log black-box show` tells the newest", soft_wrap=True)


def show(path: Path | None, out: Path | None, console: Console) -> None:
    kept = [dated(box) for box in kept_boxes()]
    chosen = _chosen(path, kept)
    boxes = together(chosen, kept)
    target = out or Path("out") / f"black-box-{chosen.when:%Y%m%dT%H%M%S}-{chosen.robot}"
    log = run_folder(target) / "run.lcmlog"
    count = write_log(boxes, log)
    if not count:
        raise InputError(f"{', '.join(str(box.path) for box in boxes)}: nothing readable in them")
    for box in boxes:
        console.print(f"{box.program}: {box.code}  [dim]{box.path}[/]", soft_wrap=True)
    robot = _robot_of(chosen.robot, target, console)
    names = Names(robot.joint_names if robot else [], law_names())
    show_events(log_file(log), None, names, console)
    for file in plot(log, [], None, Console(quiet=True)):
        if file.suffix == ".html" or file.stem == "overview":
            console.print(f"drawn: {file}", soft_wrap=True)
    if robot is not None:
        _reproduce(Log(log), robot, target / "reproduce.yaml", console)
    console.print(f"{log}: {count} messages", soft_wrap=True)


def reproduce(path: Path, robot: str | None, out: Path | None, console: Console) -> None:
    """A scenario from any log. `robot`: where the log lies in no folder of a run."""
    log = log_file(path)
    loaded = robot_beside(log.parent) if robot is None else load_robot(robot)
    if loaded is None:
        raise InputError(f"no robot.yaml beside {log}: give --robot")
    _reproduce(Log(log), loaded, out or log.parent / "reproduce.yaml", console)


def _reproduce(log: Log, robot: Robot, file: Path, console: Console) -> None:
    """The scenario names the folder of the robot, relative to its own where that is possible."""
    folder = robot.folder
    way = os.path.relpath(folder, file.resolve().parent)
    name = "./" if way == "." else f"./{way}"
    made = reproduction(log, name, robot.joint_names)
    if made is None:
        console.print("no scenario: the log holds no state in which all drives had answered")
        return
    write_again(file, made.text())
    console.print(f"the same in simulation: limber lab {file} --out DIR", soft_wrap=True)
    for note in made.notes:
        console.print(f"  {note}")


def _chosen(path: Path | None, kept: list[Box]) -> Box:
    if path is None:
        if not kept:
            raise InputError(f"no black box is kept in {folder()}")
        return max(kept, key=lambda box: box.when)
    existing_file(path, "black box (.box)")
    chosen = next((box for box in kept if box.path.samefile(path)), None)
    if chosen is None:
        raise InputError(f"{path} is none of the black boxes in {folder()}")
    return chosen


def _robot_of(name: str, target: Path, console: Console) -> Robot | None:
    """The shipped robot of that name, copied beside the log; None if it is unknown."""
    try:
        robot = load_robot(name)
    except InputError:
        console.print(
            f"{name} is no shipped robot: joints are numbered, and there is no scenario; "
            f"limber log black-box reproduce {target} --robot FOLDER makes it",
            soft_wrap=True,
        )
        return None
    keep_description(robot, target)
    return robot_beside(target)
