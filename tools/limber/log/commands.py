"""`limber log ...`: what is in a log, as text, CSV or numpy."""

import csv
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.text import Text

from limber import messages, tables
from limber.errors import InputError
from limber.log import events
from limber.log.reader import Log, log_file
from limber.paths import output_folder


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


def convert(path: Path, out: Path, console: Console) -> None:
    log = Log(path)
    if out.suffix == ".npz":
        output_folder(out.parent)
        np.savez_compressed(out, **_arrays(log))
        console.print(f"wrote {out}")
    elif out.suffix == "":
        output_folder(out)
        for name in _fixed(log):
            _write_csv(out / f"{name}.csv", log.read(name))
            console.print(f"wrote {out / name}.csv")
    else:
        raise InputError(f"--out {out}: end it in .npz, or name a folder for CSV files")


def _fixed(log: Log) -> list[str]:
    """Channels whose type has no strings: those that are numbers."""
    return [
        name
        for name in sorted(log.channels)
        if log.type_of(name) and messages.dtype_of(log.type_of(name)) is not None
    ]


def _arrays(log: Log) -> dict[str, np.ndarray]:
    """CHANNEL.field -> array, one row a message."""
    return {
        f"{name}.{field}": log.read(name)[field]
        for name in _fixed(log)
        for field in log.read(name).dtype.names
        if field != messages.FINGERPRINT
    }


def _write_csv(path: Path, records: np.ndarray) -> None:
    columns: dict[str, np.ndarray] = {}
    for field in records.dtype.names:
        if field == messages.FINGERPRINT:
            continue
        values = records[field].reshape(len(records), -1)
        for i in range(values.shape[1]):
            columns[field if values.shape[1] == 1 else f"{field}[{i}]"] = values[:, i]
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(zip(*(values.tolist() for values in columns.values()), strict=True))
