"""`limber log ...`: what is in a log, as text."""

from collections.abc import Iterator
from datetime import UTC, datetime
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.text import Text

from limber import messages, tables
from limber.errors import InputError
from limber.log import events
from limber.log.reader import Log, log_file

A_DATE_us = 10**15  # smaller time stamps are no dates: the lab's are arm time
DECODED_AT_ONCE = 100


def info(path: Path, console: Console) -> None:
    log = Log(path)
    table = tables.table("<channel", "<type", ">messages", ">lost", ">undecodable", ">kB")
    for name, found in sorted(log.channels.items()):
        table.add_row(
            name,
            log.type_of(name) or "unknown",
            str(len(found)),
            str(log.lost(name)) if log.type_of(name) else "-",
            str(log.undecodable(name)),
            f"{sum(found.sizes) / 1e3:.0f}",
        )
    count = sum(len(found) for found in log.channels.values())
    on_disk = f"{log.path.stat().st_size / 1e6:.1f} MB"
    console.print(f"{log.path}: {count} messages in {log.length_s:.2f} s, {on_disk}")
    for line in (_recorded(log), *_arms(log)):
        console.print(line, markup=False)
    if log.damage():
        console.print(f"[yellow]{log.damage()}[/]")
    console.print(table)


def _recorded(log: Log) -> str:
    if log.first_us < A_DATE_us:
        return "time stamps: arm time"
    when = datetime.fromtimestamp(log.first_us * 1e-6, UTC)
    return f"recorded from {when:%Y-%m-%d %H:%M:%S} UTC on"


def _arms(log: Log) -> list[str]:
    """What ROBOT_INFO tells, once each."""
    told = (
        f"robot: {info.robot}, {info.num_joints} joints, {info.rate_hz:g} Hz, "
        + ("simulated" if info.simulated else "real motors")
        for info in log.decode("ROBOT_INFO")
    )
    return list(dict.fromkeys(told))


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
    log.chosen([channel])
    known = log.type_of(channel)
    fields = messages.message_class(known).__slots__ if known else []
    if field is not None and field not in fields:
        raise InputError(f"{channel} has no field '{field}': {', '.join(fields)}")
    shown = 0
    for message in islice(_from(log, channel, at_s), count):
        if shown and field is None:
            print("---")
        for name in fields if field is None else [field]:
            value = _short(getattr(message, name), getattr(message, "num_joints", None))
            print(value if field else f"{name}: {value}")
        shown += 1
    if not shown and log.undecodable(channel) == len(log.channels[channel]):
        raise InputError(
            f"{log.path}: {channel} was recorded by another version of limber, or is no {known}"
        )
    if not shown:
        raise InputError(f"{channel} has no message from {at_s:g} s on")


def _from(log: Log, channel: str, at_s: float) -> Iterator[Any]:
    for start in range(0, len(log.channels[channel]), DECODED_AT_ONCE):
        for _, message in log.objects(channel, start, start + DECODED_AT_ONCE):
            if message.time_ns >= at_s * 1e9:
                yield message


def _short(value: Any, joints: int | None) -> Any:
    """Per-joint arrays without their unused rest."""
    if isinstance(value, list | tuple) and len(value) == 16 and joints:
        return list(value[:joints])
    return list(value) if isinstance(value, tuple) else value
