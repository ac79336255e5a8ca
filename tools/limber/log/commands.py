"""`limber log ...`: what is in a log, as text."""

from collections.abc import Iterator
from datetime import UTC, datetime
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table
from rich.text import Text

from limber import messages, tables
from limber.errors import InputError
from limber.log import events
from limber.log.reader import Log, log_file

A_DATE_us = 10**15  # smaller time stamps are no dates: the lab's are arm time
DECODED_AT_ONCE = 100


MOST_RUNS = 20  # that are listed


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
    for line in (_recorded(log), *_arms(log), *_runs(log), *_jumps(log)):
        console.print(line, markup=False, soft_wrap=True)
    if log.damage():
        console.print(f"[yellow]{log.damage()}[/]")
    console.print(table)


def _runs(log: Log) -> list[str]:
    """One line a run, if there are several."""
    if log.runs == 1:
        return []
    lines = [f"{log.runs} runs, one after the other; --run N of other commands chooses one:"]
    for number, part in enumerate(log.each_run()[:MOST_RUNS], 1):
        count = sum(len(found) for found in part.channels.values())
        arms = "; ".join(_arms(part))
        lines.append(f"  run {number}: {count} messages in {part.length_s:.2f} s; {arms}")
    return lines


def _jumps(log: Log) -> list[str]:
    """Numbers that no loss explains."""
    return [
        f"{name}: {jumps} jumps of its numbers are too great for a loss and count as none: damaged "
        "messages, or somebody else's"
        for name in sorted(log.channels)
        if (jumps := log.jumps(name))
    ]


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
        for info in log.each("ROBOT_INFO")
    )
    return list(dict.fromkeys(told))


def rate(path: Path, run: int | None, console: Console) -> None:
    """Within each run: the pause between two is nobody's jitter."""
    log = Log(path)
    for number, part in zip(_numbers(log, run), log.each_run(run), strict=True):
        title = f"run {number} of {log.runs}" if log.runs > 1 else None
        console.print(_rates(part, title))


def _numbers(log: Log, run: int | None) -> list[int]:
    return list(range(1, log.runs + 1)) if run is None else [run]


def _rates(log: Log, title: str | None) -> Table:
    columns = (">Hz", ">median ms", ">99 % ms", ">longest ms", ">lost")
    table = tables.table("<channel", *columns, title=title)
    for name in sorted(log.channels):
        gaps_ms = np.diff(np.sort(log.stamps_s(name))) * 1e3
        if not len(gaps_ms) or not gaps_ms.sum():
            table.add_row(name, *["-"] * 5)
            continue
        median, high = np.percentile(gaps_ms, [50, 99])
        cells = (1e3 / gaps_ms.mean(), median, high, gaps_ms.max())
        lost = str(log.lost(name)) if log.type_of(name) else "-"
        table.add_row(name, *(f"{value:.3f}" for value in cells), lost)
    return table


def show_events(path: Path, run: int | None, names: events.Names, console: Console) -> None:
    """In the order they were recorded in: run after run."""
    log = Log(path)
    table = tables.table(">s", "<who", "~what", title=f"{log_file(path)}")
    for number, part in zip(_numbers(log, run), log.each_run(run), strict=True):
        if log.runs > 1:
            told = f"run {number} of {log.runs}: {'; '.join(_arms(part)) or 'arm time begins anew'}"
            table.add_section()
            table.add_row("", "log", Text(told, style="bold"))
        for event in events.events(part, names):
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
