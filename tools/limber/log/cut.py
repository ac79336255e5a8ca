"""`limber log cut`: a part of a log, as a log: whole events, byte for byte."""

from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from limber.errors import InputError
from limber.log.event_writer import EventWriter
from limber.log.reader import Log
from limber.log.results import complete_or_nothing


@dataclass(frozen=True)
class Part:
    """`begin_s`, `end_s`: since the first message, of a run if one is named. No channels: all."""

    begin_s: float = 0.0
    end_s: float = float("inf")
    channels: tuple[str, ...] = ()
    run: int | None = None


def cut(path: Path, out: Path, part: Part, console: Console) -> None:
    if not out.name.endswith((".lcmlog", ".lcmlog.zst")):
        raise InputError(f"--out {out}: end it in .lcmlog, or .lcmlog.zst to compress it")
    log = Log(path)
    log = log if part.run is None else log.of_run(part.run)
    channels = log.chosen(part.channels)
    if part.begin_s >= min(part.end_s, log.length_s):
        raise InputError(f"--from {part.begin_s:g}: the log ends after {log.length_s:g} s")
    with complete_or_nothing(out) as place:
        count = copy_events(log, place, out.suffix == ".zst", channels, part)
        if not count:
            raise InputError(f"{log.path}: no message in this part")
    if log.damage():
        console.print(log.damage(), style="yellow", markup=False, soft_wrap=True)
    console.print(f"wrote {out}: {count} messages", soft_wrap=True)


def copy_events(
    log: Log, to: Path, compress: bool, channels: Collection[str], part: Part | None = None
) -> int:
    """Returns how many."""
    part = part or Part()
    begin_us, end_us = (log.first_us + s * 1e6 for s in (part.begin_s, part.end_s))
    writer = EventWriter(to, compress)
    count = 0
    for stamp_us, event in log.whole_events(channels):
        if begin_us <= stamp_us <= end_us:
            writer.write(event)
            count += 1
    writer.close()
    return count
