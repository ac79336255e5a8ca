"""The episodes of a log: what lies between its marks (episode_mark_t), with task and outcome."""

import errno
import fcntl
import os
from collections.abc import Collection, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import zstandard
from rich.console import Console
from rich.text import Text

from limber import tables
from limber.errors import InputError
from limber.log.event_file import HEADER, SYNC
from limber.log.reader import Log, log_file
from limber.messages import message_class

CHANNEL, KEPT = "EPISODE", "EPISODE_KEPT"
MARK = message_class("episode_mark_t")
OUTCOMES = {MARK.MARK_SUCCESS: "success", MARK.MARK_FAILURE: "failure"}


@dataclass(frozen=True)
class Episode:
    """`number`: from 1 on; `mark`: seq of its MARK_START; `start_us`, `end_us`: time stamps of the
    log, the end that of the last message if there is no end; `outcome`: success, failure, or empty.
    """

    number: int
    mark: int
    start_us: int
    end_us: int
    task: str
    outcome: str = ""
    dropped: bool = False
    ended: bool = False

    @property
    def length_s(self) -> float:
        return (self.end_us - self.start_us) * 1e-6


def episodes(log: Log) -> list[Episode]:
    """All of the log, in its order; marks that belong to none of them are left out."""
    found: dict[int, Episode] = {}
    newest = 0
    for stamp_us, mark in _marks(log):
        if mark.mark == MARK.MARK_START:
            if newest and not found[newest].ended:
                found[newest] = replace(found[newest], end_us=stamp_us, ended=True)
            newest = mark.seq
            task = "".join(c if c.isprintable() else "?" for c in mark.task)
            found[newest] = Episode(len(found) + 1, newest, stamp_us, stamp_us, task)
            continue
        meant = mark.episode or newest
        if meant not in found:
            continue
        episode = found[meant]
        if mark.mark in OUTCOMES:  # the last one counts, and the first end
            end_us = episode.end_us if episode.ended else stamp_us
            found[meant] = replace(episode, outcome=OUTCOMES[mark.mark], end_us=end_us, ended=True)
        else:
            found[meant] = replace(episode, dropped=mark.mark == MARK.MARK_DROP)
    last_us = log.first_us + round(log.length_s * 1e6) if found else 0
    return [e if e.ended else replace(e, end_us=last_us) for e in found.values()]


def _marks(log: Log) -> Iterator[tuple[int, Any]]:
    """In form and content marks, each once."""
    seen: set[int] = set()
    for stamp_us, mark in log.objects(CHANNEL, 0, None):
        known = MARK.MARK_START <= mark.mark <= MARK.MARK_KEEP and mark.seq > 0
        if known and mark.seq not in seen and len(mark.task.encode()) <= MARK.LONGEST_TASK:
            seen.add(mark.seq)
            yield stamp_us, mark


def of_part(found: list[Episode], part: Log) -> list[Episode]:
    """Those that begin in a part of their log, such as a run."""
    begun = {mark.seq for mark in part.each(CHANNEL)}
    return [episode for episode in found if episode.mark in begun]


def chosen(found: list[Episode], numbers: Collection[int]) -> list[Episode]:
    """Those with these numbers; without any all that are not dropped."""
    missing = set(numbers) - {episode.number for episode in found}
    if missing:
        raise InputError(f"episode {min(missing)}: this log has {len(found)}, from 1 on")
    return [e for e in found if (e.number in numbers if numbers else not e.dropped)]


def usable(found: list[Episode]) -> tuple[list[Episode], list[str]]:
    """Those of which data are made, and why the others are none."""
    told = [
        f"episode {one.number} is left out: {'dropped' if one.dropped else 'it has no end'}"
        for one in found
        if one.dropped or not one.outcome
    ]
    return [one for one in found if one.outcome and not one.dropped], told


def show(path: Path, console: Console) -> None:
    log = Log(path)
    found = episodes(log)
    if not found:
        console.print(f"{log.path}: no episodes; limber log record --episodes marks them")
        return
    table = tables.table(">episode", ">from s", ">length s", "<outcome", "<", "~task")
    for one in found:
        table.add_row(
            str(one.number),
            f"{(one.start_us - log.first_us) * 1e-6:.2f}",
            f"{one.length_s:.2f}",
            one.outcome or "no end",
            "dropped" if one.dropped else "",
            Text(one.task),
        )
    console.print(table)


def mark(path: Path, drop: Collection[int], keep: Collection[int]) -> None:
    """Adds marks behind the last event: nothing that was recorded is changed."""
    file = log_file(path)
    added = _added(file, drop, keep)
    _require_alone(file)
    if file.suffix == ".zst":
        added = zstandard.ZstdCompressor(write_checksum=True).compress(added)
    with open(file, "ab") as log:
        log.write(added)
        log.flush()
        os.fsync(log.fileno())


def _added(file: Path, drop: Collection[int], keep: Collection[int]) -> bytes:
    """The events; the log is closed then, so that nobody is told that it is written to."""
    log = Log(file)
    if log.cut_off:
        raise InputError(
            f"{file}: {log.damage()}; limber log cut copies what is whole, mark the copy"
        )
    found = episodes(log)
    seq = max((message.seq for message in log.each(CHANNEL)), default=0)
    last_us = log.first_us + round(log.length_s * 1e6)
    data = b""
    for kind, numbers in ((MARK.MARK_DROP, drop), (MARK.MARK_KEEP, keep)):
        for episode in chosen(found, numbers) if numbers else ():
            message = MARK()
            seq += 1
            message.seq, message.mark, message.episode = seq, kind, episode.mark
            body, name = message.encode(), CHANNEL.encode()
            data += HEADER.pack(SYNC, 0, last_us, len(name), len(body)) + name + body
    return data


def _require_alone(file: Path) -> None:
    """A recorder that is still at it would write over what is added. A lease, fcntl(2), is granted
    where nobody writes.
    """
    with open(file, "rb") as log, suppress(PermissionError):
        try:
            fcntl.fcntl(log, fcntl.F_SETLEASE, fcntl.F_RDLCK)
            fcntl.fcntl(log, fcntl.F_SETLEASE, fcntl.F_UNLCK)
        except OSError as error:
            if error.errno != errno.EAGAIN:
                raise
            raise InputError(
                f"{file} is being recorded: drop an episode by key, page or Python"
            ) from None
