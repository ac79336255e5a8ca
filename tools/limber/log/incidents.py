"""`limber incident`: lists black boxes, and makes one log of those of an incident."""

from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

from rich.console import Console

from limber import tables
from limber.errors import InputError
from limber.log.black_box import NAME, Incident, folder, incidents, read, together, write_log
from limber.log.commands import show_events
from limber.log.events import Names
from limber.log.reader import log_file
from limber.paths import ROOT, existing_file, output_folder

KILLED = "killed"


def dated(box: Incident) -> Incident:
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
    found = sorted(map(dated, incidents()), key=lambda box: box.when)
    if not found:
        console.print(f"no incident is kept in {folder()}", soft_wrap=True)
        return
    table = tables.table("<when (UTC)", "<robot", "<kept by", "<because of", "~file")
    for box in found:
        when = f"{box.when:%Y-%m-%d %H:%M:%S}"
        table.add_row(when, box.robot, box.program, box.code, box.path.name)
    console.print(table)
    console.print(f"in {folder()}; `limber incident show` tells the newest", soft_wrap=True)


def show(
    path: Path | None, out: Path | None, names_of: Callable[[str], Names], console: Console
) -> None:
    """`names_of`: of the joints and laws of a robot."""
    kept = [dated(box) for box in incidents()]
    if path is None:
        if not kept:
            raise InputError(f"no incident is kept in {folder()}")
        chosen = max(kept, key=lambda box: box.when)
    else:
        existing_file(path, "black box (.box)")
        name = NAME.fullmatch(path.name)
        chosen = next((box for box in kept if box.path.samefile(path)), None) if name else None
        if chosen is None:
            raise InputError(f"{path} is none of the incidents in {folder()}")
    boxes = together(chosen, kept)
    target = out or ROOT / "out" / f"incident-{chosen.when:%Y%m%dT%H%M%S}-{chosen.robot}"
    log = output_folder(target) / "run.lcmlog"
    count = write_log(boxes, log)
    if not count:
        raise InputError(f"{', '.join(str(box.path) for box in boxes)}: nothing readable in them")
    for box in boxes:
        console.print(f"{box.program}: {box.code}  [dim]{box.path}[/]", soft_wrap=True)
    show_events(log_file(log), names_of(chosen.robot), console)
    console.print(f"{log}: {count} messages; limber plot {target}", soft_wrap=True)
