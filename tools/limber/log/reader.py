"""Reads LCM event logs: whole channels at once, damaged files as far as they are good.

LCM's own reader stops at the first damaged byte. This one continues at the next whole event and
reports what it skipped.
"""

import mmap
import struct
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from limber import messages
from limber.errors import InputError
from limber.paths import existing_file

SYNC = b"\xed\xa1\xda\x01"
HEADER = struct.Struct(">4sqqii")  # sync word, event number, time stamp in µs, two lengths
MAX_CHANNEL_BYTES = 255
MAX_DATA_BYTES = 1 << 26


@dataclass
class Events:
    """Where one channel's events lie in the file."""

    offsets: list[int] = field(default_factory=list)
    sizes: list[int] = field(default_factory=list)
    stamps_us: list[int] = field(default_factory=list)

    def __len__(self) -> int:
        return len(self.offsets)


class Log:
    """An event log. `skipped_bytes`: damaged; `truncated_bytes`: an unfinished event at the end."""

    def __init__(self, path: Path | str) -> None:
        self.path = log_file(Path(path))
        self.channels: dict[str, Events] = {}
        self.skipped_bytes = 0
        self.truncated_bytes = 0
        self._arrays: dict[str, np.ndarray] = {}
        if self.path.stat().st_size == 0:
            raise InputError(f"{self.path} is empty: nothing was recorded")
        with open(self.path, "rb") as file:
            self._data = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
        self._index()
        if not self.channels:
            raise InputError(f"{self.path} is no LCM event log: it holds no event")

    def _index(self) -> None:
        data, end = self._data, len(self._data)
        position = 0
        while position < end:
            event = _event_at(data, position, end)
            if event is None:
                position = self._skip_damage(position, end)
                continue
            start, size, stamp, channel, after = event
            events = self.channels.setdefault(channel, Events())
            events.offsets.append(start)
            events.sizes.append(size)
            events.stamps_us.append(stamp)
            position = after

    def _skip_damage(self, position: int, end: int) -> int:
        """Counts what is left out and returns where the next whole event starts."""
        candidate = self._data.find(SYNC, position + 1)
        while candidate != -1 and _event_at(self._data, candidate, end) is None:
            candidate = self._data.find(SYNC, candidate + 1)
        if candidate != -1:
            self.skipped_bytes += candidate - position
            return candidate
        if _unfinished(self._data, position, end):
            self.truncated_bytes = end - position
        else:
            self.skipped_bytes += end - position
        return end

    def type_of(self, channel: str) -> str | None:
        """Message type by the channel table; None for channels that are not limber's."""
        row = messages.channels().get(channel)
        return row.type_name if row else None

    def raw(self, channel: str) -> list[bytes]:
        events = self.channels.get(channel, Events())
        places = zip(events.offsets, events.sizes, strict=True)
        return [self._data[offset : offset + size] for offset, size in places]

    def read(self, channel: str) -> np.ndarray:
        """All messages of a fixed-size channel as one structured array; empty if there are none."""
        if channel not in self._arrays:
            self._arrays[channel] = self._read(channel)
        return self._arrays[channel]

    def _read(self, channel: str) -> np.ndarray:
        type_name = self.type_of(channel)
        wire = messages.dtype_of(type_name) if type_name else None
        if wire is None:
            raise InputError(
                f"channel '{channel}' has no fixed-size limber type; this log has: "
                + ", ".join(sorted(self.channels))
            )
        native = messages.native_dtype_of(type_name)
        events = self.channels.get(channel)
        if events is None:
            return np.empty(0, native)
        offsets = np.asarray(events.offsets)[np.asarray(events.sizes) == wire.itemsize]
        rows = np.frombuffer(self._data, np.uint8)[offsets[:, None] + np.arange(wire.itemsize)]
        records = rows.view(wire)[:, 0]
        known = records[messages.FINGERPRINT] == messages.fingerprint_of(type_name)
        if len(known) and not known.any():
            raise InputError(
                f"{self.path}: {channel} was recorded by another version of limber "
                f"({type_name} has changed since)"
            )
        return records[known].astype(native)

    def decode(self, channel: str) -> list[Any]:
        """Messages of any limber channel as objects, one by one (slow; for events with strings)."""
        type_name = self.type_of(channel)
        if type_name is None:
            raise InputError(
                f"channel '{channel}' is not one of limber's: " + ", ".join(messages.channels())
            )
        decoded = []
        for data in self.raw(channel):
            try:
                decoded.append(messages.decode(type_name, data))
            except ValueError:
                continue  # another type on this channel; counted by undecodable()
        return decoded

    def undecodable(self, channel: str) -> int:
        type_name = self.type_of(channel)
        if type_name is None:
            return len(self.channels[channel])
        fingerprint = messages.fingerprint_of(type_name).to_bytes(8, "big")
        return sum(not data.startswith(fingerprint) for data in self.raw(channel))

    def lost(self, channel: str) -> int:
        """Messages that never arrived, by gaps in the sequence number (the first field of each) of
        each sender. Requests and answers have no numbers that would tell: 0.
        """
        row = messages.channels().get(channel)
        if row is None or not row.numbered:
            return 0
        try:
            records = self.read(channel)
        except InputError:
            return 0  # of another version: nothing in it is known
        numbers = records[records.dtype.names[1]]
        sender = next((name for name in messages.SENDERS if name in records.dtype.names), None)
        if sender is None:
            return count_gaps(numbers)
        return sum(count_gaps(numbers[records[sender] == s]) for s in np.unique(records[sender]))

    def stamps_s(self, channel: str) -> np.ndarray:
        return np.asarray(self.channels[channel].stamps_us) * 1e-6

    def damage(self) -> str:
        """One sentence on what could not be read; empty if everything was."""
        parts = []
        if self.skipped_bytes:
            parts.append(f"{self.skipped_bytes} damaged bytes skipped")
        if self.truncated_bytes:
            parts.append(f"the last event is cut off ({self.truncated_bytes} bytes)")
        return ", ".join(parts)


def time_s(records: np.ndarray) -> np.ndarray:
    """Arm time of messages, s."""
    return records["time_ns"] * 1e-9


def count_gaps(sequence: np.ndarray) -> int:
    """Missing numbers. A number that goes back is a new run of the sender, not a loss."""
    steps = np.diff(sequence)
    return int((steps[steps > 1] - 1).sum())


def log_file(path: Path) -> Path:
    """`path` itself, or the run.lcmlog in it if it is the folder of a run."""
    if path.is_dir():
        if not (path / "run.lcmlog").is_file():
            raise InputError(f"{path} holds no run.lcmlog: give a log, or the folder of a run")
        return path / "run.lcmlog"
    return existing_file(path, "log, or the folder of a run,")


def _event_at(data: mmap.mmap, position: int, end: int) -> tuple[int, int, int, str, int] | None:
    """The event at `position` as (data start, size, stamp, channel, end), if it is whole.

    Whole means that the file ends behind it, or another event starts there: bytes lost or added in
    the
    middle of an event shift what follows, and then nothing can vouch for its contents.
    """
    start = position + HEADER.size
    if start > end:
        return None
    sync, _, stamp, channel_size, size = HEADER.unpack_from(data, position)
    if sync != SYNC or not 0 < channel_size <= MAX_CHANNEL_BYTES or not 0 <= size <= MAX_DATA_BYTES:
        return None
    after = start + channel_size + size
    if after > end or (after < end and not SYNC.startswith(data[after : after + 4])):
        return None
    name = data[start : start + channel_size]
    if not name.isascii():
        return None
    return start + channel_size, size, stamp, name.decode("ascii"), after


def _unfinished(data: mmap.mmap, position: int, end: int) -> bool:
    """True if the rest of the file looks like the beginning of an event."""
    return SYNC.startswith(data[position : min(position + 4, end)])
