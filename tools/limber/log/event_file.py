"""The events of an LCM event log, one after the other, damaged files as far as they are good.

LCM's own reader stops at the first damaged byte. This one continues at the next whole event and
counts what it skipped.
"""

import fcntl
import mmap
import signal
import struct
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO, NoReturn

from limber.errors import InputError, RunError
from limber.log import compressed

SYNC = b"\xed\xa1\xda\x01"
HEADER = struct.Struct(">4sqqii")  # sync word, event number, time stamp in µs, two lengths
MAX_CHANNEL_BYTES = 255
MAX_DATA_BYTES = 1 << 26

# where it begins, where its data begin, their size, time stamp in µs, channel, where it ends
Event = tuple[int, int, int, int, str, int]
Names = dict[bytes, str]


@dataclass
class Damage:
    """`skipped_bytes`: inside the file; `truncated_bytes`: an unfinished event at the end; the same
    of compressed blocks.
    """

    skipped_bytes: int = 0
    truncated_bytes: int = 0
    packed_skipped_bytes: int = 0
    packed_truncated_bytes: int = 0

    def __str__(self) -> str:
        """One sentence on what could not be read; empty if everything was."""
        parts = []
        if self.skipped_bytes:
            parts.append(f"{self.skipped_bytes} damaged bytes skipped")
        if self.truncated_bytes:
            parts.append(f"the last event is cut off ({self.truncated_bytes} bytes)")
        if self.packed_skipped_bytes:
            parts.append(f"{self.packed_skipped_bytes} damaged compressed bytes skipped")
        if self.packed_truncated_bytes:
            parts.append(f"the last block is cut off ({self.packed_truncated_bytes} bytes)")
        return ", ".join(parts)


def contents(path: Path, damage: Damage) -> mmap.mmap:
    """The bytes of a log, also of a compressed one; their memory is the system's to reclaim."""
    if path.stat().st_size == 0:
        raise InputError(f"{path} is empty: nothing was recorded")
    with open(path, "rb") as file:
        _watch(file, path)
        data = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
    if data[:4] != compressed.FRAME and path.suffix != ".zst":
        return data
    plain, damage.packed_skipped_bytes, damage.packed_truncated_bytes = compressed.unpack(
        data, path
    )
    with plain, data:
        if plain.tell() == 0:
            raise InputError(f"{path} is no compressed log: it holds no whole block")
        plain.flush()
        return mmap.mmap(plain.fileno(), 0, access=mmap.ACCESS_READ)


def _watch(file: IO[bytes], path: Path) -> None:
    """A file that somebody else is about to cut or to write to is given up: what is mapped here and
    is no more would end the program without a word. A lease, fcntl(2), has the other one wait until
    then; where there is none (another owner, a recorder that is still at it), there is no guard.
    """

    def give_up(*_: object) -> NoReturn:
        raise RunError(
            f"{path} is cut, or written to, while it is read: read it again, or a copy of it"
        )

    with suppress(OSError, ValueError):  # ValueError: not in the main thread
        signal.signal(signal.SIGIO, give_up)
        fcntl.fcntl(file, fcntl.F_SETLEASE, fcntl.F_RDLCK)


def events(data: mmap.mmap, damage: Damage) -> Iterator[Event]:
    """All whole events; what is left out is added to `damage`."""
    position, end = 0, len(data)
    names: Names = {}
    while position < end:
        event = _event_at(data, position, end, names)
        if event is None:
            position = _skip(data, position, end, damage)
        else:
            yield event
            position = event[-1]


def _skip(data: mmap.mmap, position: int, end: int, damage: Damage) -> int:
    """Where the next whole event begins."""
    candidate = data.find(SYNC, position + 1)
    while candidate != -1 and _event_at(data, candidate, end, {}) is None:
        candidate = data.find(SYNC, candidate + 1)
    if candidate != -1:
        damage.skipped_bytes += candidate - position
        return candidate
    if SYNC.startswith(data[position : min(position + 4, end)]):  # the beginning of an event
        damage.truncated_bytes += end - position
    else:
        damage.skipped_bytes += end - position
    return end


def _event_at(data: mmap.mmap, position: int, end: int, names: Names) -> Event | None:
    """The event at `position`, if it is whole. `names`: channels seen before.

    Whole means that the file ends behind it, or another event starts there: bytes lost or added in
    the middle of an event shift what follows, and then nothing can vouch for its contents.
    """
    start = position + HEADER.size
    if start > end:
        return None
    sync, _, stamp_us, channel_size, size = HEADER.unpack_from(data, position)
    if sync != SYNC or not 0 < channel_size <= MAX_CHANNEL_BYTES or not 0 <= size <= MAX_DATA_BYTES:
        return None
    begin = start + channel_size
    after = begin + size
    if data[after : after + 4] != SYNC and not _ends(data, after, end):
        return None
    name = data[start:begin]
    if name not in names:
        if not name.isascii():
            return None
        names[name] = name.decode("ascii")
    return position, begin, size, stamp_us, names[name], after


def _ends(data: mmap.mmap, after: int, end: int) -> bool:
    """The file ends at `after`, or in the sync word that begins there."""
    return after <= end and SYNC.startswith(data[after : after + 4])
