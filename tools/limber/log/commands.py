"""`limber log ...`: what is in a log, as text."""

from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.text import Text

from limber import messages, tables
from limber.errors import InputError
from limber.log import events
from limber.log.reader import Log, log_file


def info(path: Path, console: Console) -> None:
    log = Log(path)
    table = tables.table("<channel", "<type", ">messages", ">lost", ">undecodable", ">kB")
    stamps = [stamp for channel in log.channels.values() for stamp in channel.stamps_us]
    for name, found in sorted(log.channels.items()):
        table.add_row(
            name,
            log.type_of(name) or "unknown",
            str(len(found)),
            str(log.lost(name)) if log.type_of(name) else "-",
            str(log.undecodable(name)),
            f"{sum(found.sizes) / 1e3:.0f}",
        )
    duration_s = (max(stamps) - min(stamps)) * 1e-6
    console.print(f"{log.path}: {len(stamps)} messages in {duration_s:.2f} s")
    if log.damage():
        console.print(f"[yellow]{log.damage()}[/]")
    console.print(table)


def rate(path: Path, console: Console) -> None:
    log = Log(path)
    columns = (">Hz", ">median ms", ">99 % ms", ">longest ms", ">lost")
    table = tables.table("<channel", *columns)
    for name in sorted(log.channels):
        gaps_ms = np.diff(np.sort(log.stamps_s(name))) * 1e3
        if not len(gaps_ms) or not gaps_ms.sum():
            table.add_row(name, *["-"] * 5)
            continue
        median, high = np.percentile(gaps_ms, [50, 99])
        cells = (1e3 / gaps_ms.mean(), median, high, gaps_ms.max())
        lost = str(log.lost(name)) if log.type_of(name) else "-"
        table.add_row(name, *(f"{value:.3f}" for value in cells), lost)
    console.print(table)


def show_events(path: Path, names: events.Names, console: Console) -> None:
    table = tables.table(">s", "<who", "~what", title=f"{log_file(path)}")
    for event in events.events(Log(path), names):
        text = Text(event.text, style="red" if event.bad else "")
        table.add_row(f"{event.time_s:.3f}", event.who, text)
    console.print(table)


def echo(path: Path, channel: str, field: str | None, count: int, at_s: float) -> None:
    log = Log(path)
    known = log.type_of(channel)
    if channel not in log.channels:
        raise InputError(f"no channel '{channel}' in this log: {', '.join(sorted(log.channels))}")
    fields = messages.message_class(known).__slots__ if known else []
    if field is not None and field not in fields:
        raise InputError(f"{channel} has no field '{field}': {', '.join(fields)}")
    decoded = (message for message in log.decode(channel) if message.time_ns >= at_s * 1e9)
    shown = 0
    for message in decoded:
        if shown and field is None:
            print("---")
        for name in fields if field is None else [field]:
            value = _short(getattr(message, name), getattr(message, "num_joints", None))
            print(value if field else f"{name}: {value}")
        shown += 1
        if shown == count:
            return
    if not shown:
        raise InputError(f"{channel} has no message from {at_s:g} s on")


def _short(value: Any, joints: int | None) -> Any:
    """Per-joint arrays without their unused rest."""
    if isinstance(value, list | tuple) and len(value) == 16 and joints:
        return list(value[:joints])
    return list(value) if isinstance(value, tuple) else value
