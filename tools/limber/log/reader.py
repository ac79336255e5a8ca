"""Reads LCM event logs: whole channels at once, damaged files as far as they are good."""

import copy
from collections.abc import Collection, Iterator, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib import recfunctions

from limber import messages
from limber.arrays import Flags
from limber.errors import InputError
from limber.log import runs
from limber.log.event_file import Damage, contents, events
from limber.log.event_index import NO_EVENTS, bytes_of, index
from limber.paths import existing_file

LOG_NAMES = ("run.lcmlog", "run.lcmlog.zst")  # what a run leaves, plain or compressed
PIECE = 1 << 14  # messages read at a time where only some fields count
OBJECTS = 1 << 10  # decoded at a time
MOST_LOST = 10**7  # in a row: hours without a message; a greater gap is no loss


class Log:
    """An event log. `skipped_bytes`: damaged; `truncated_bytes`: an unfinished event at the end."""

    def __init__(self, path: Path | str) -> None:
        self.path = log_file(Path(path))
        self._damage = Damage()
        self._arrays: dict[str, np.ndarray] = {}
        self._data = contents(self.path, self._damage)
        self.channels = index(self._data, self._damage)
        if not self.channels:
            raise InputError(f"{self.path} is no LCM event log: it holds no event")
        self._span = (0, len(self._data))

    @cached_property
    def runs(self) -> int:
        """How many runs it holds, one after the other; see runs.py."""
        return len(self._borders) - 1

    @cached_property
    def _borders(self) -> list[int]:
        """Where the runs begin in the file, and where the last one ends."""
        begin, end = self._span
        by = next((channel for channel in runs.BY if channel in self.channels), None)
        if by is None:
            return [begin, end]
        known = self._wire(by).names or ()
        fields = [name for name in ("time_ns", "session") if name in known]
        records = self.fields(by, *fields)
        fits = self._good(by)
        offsets = self.channels[by].offsets[fits]
        session = records["session"] if "session" in fields else None
        inside = [
            runs.border(self.channels, int(offsets[row - 1]), int(offsets[row]))
            for row in runs.breaks(records["time_ns"], session)
        ]
        return [begin, *inside, end]

    def of_run(self, number: int) -> "Log":
        """The part that is one run, from 1 on. Raises InputError."""
        if not 1 <= number <= self.runs:
            raise InputError(f"--run {number}: {self.path} holds {self.runs} runs, from 1 on")
        if self.runs == 1:
            return self
        begin, end = self._borders[number - 1 : number + 1]
        part = copy.copy(self)
        part.__dict__ = {
            key: value for key, value in self.__dict__.items() if key not in ("runs", "_borders")
        }
        part._arrays, part._span = {}, (begin, end)
        part.channels = {
            name: chosen
            for name, found in self.channels.items()
            if len(chosen := found.between(begin, end))
        }
        return part

    def each_run(self, chosen: int | None = None) -> list["Log"]:
        """All runs, or the one that is chosen."""
        numbers = range(1, self.runs + 1) if chosen is None else [chosen]
        return [self.of_run(number) for number in numbers]

    def one_run(self, chosen: int | None = None) -> tuple["Log", str]:
        """The chosen run, else the last one; and, if there are several, which one it is."""
        number = self.runs if chosen is None else chosen
        several = f"run {number} of {self.runs}" if self.runs > 1 else ""
        return self.of_run(number), several

    def whole_events(self, channels: Collection[str]) -> Iterator[tuple[int, bytes]]:
        """Time stamp in µs and bytes with header of the whole events, in the order of the file."""
        for begin, start, _, stamp_us, channel, end in events(self._data, Damage()):
            if channel in channels and self._span[0] <= start < self._span[1]:
                yield stamp_us, self._data[begin:end]

    def in_order(self, channels: Collection[str]) -> Iterator[tuple[int, str, bytes]]:
        """Time stamp in µs, channel and data of the whole events, in the order of the file."""
        for _, start, size, stamp_us, channel, _ in events(self._data, Damage()):
            if channel in channels and self._span[0] <= start < self._span[1]:
                yield stamp_us, channel, self._data[start : start + size]

    def type_of(self, channel: str) -> str | None:
        """Message type by the channel table; None for channels that are not limber's."""
        row = messages.channels().get(channel)
        return row.type_name if row else None

    def raw(self, channel: str, first: int = 0, last: int | None = None) -> list[bytes]:
        """The bytes of the messages first to last (not included)."""
        events = self.channels.get(channel, NO_EVENTS)
        places = events.offsets[first:last].tolist()
        sizes = events.sizes[first:last].tolist()
        return [self._data[place : place + size] for place, size in zip(places, sizes, strict=True)]

    def read(self, channel: str) -> np.ndarray:
        """All messages of a fixed-size channel as one structured array; empty if there are none."""
        if channel not in self._arrays:
            self._arrays[channel] = self._read(channel)
        return self._arrays[channel]

    def _read(self, channel: str) -> np.ndarray:
        found = len(self.channels.get(channel, ()))
        _, records = self.records(channel, 0, found)
        if found and not len(records):
            raise self._other_version(channel)
        return records

    def _other_version(self, channel: str) -> InputError:
        return InputError(
            f"{self.path}: {channel} was recorded by another version of limber "
            f"({self.type_of(channel)} has changed since)"
        )

    def fields(self, channel: str, *names: str) -> np.ndarray:
        """As read(), of these fields only: a small part of the memory."""
        if channel in self._arrays:
            return self._arrays[channel]
        found = len(self.channels.get(channel, ()))
        starts = range(0, max(found, 1), PIECE)
        pieces = [self.records(channel, start, start + PIECE)[1][list(names)] for start in starts]
        records = np.concatenate([recfunctions.repack_fields(piece) for piece in pieces])
        if found and not len(records):
            raise self._other_version(channel)
        return records

    def records(self, channel: str, first: int, last: int) -> tuple[np.ndarray, np.ndarray]:
        """Of the messages first to last (not included) of a fixed-size channel those of this
        version: their time stamps in µs, and themselves.
        """
        type_name = self.type_of(channel)
        wire = messages.dtype_of(type_name) if type_name else None
        if type_name is None or wire is None:
            raise InputError(
                f"channel '{channel}' has no fixed-size limber type; this log has: "
                + ", ".join(sorted(self.channels))
            )
        events = self.channels.get(channel, NO_EVENTS)
        fits = events.sizes[first:last] == wire.itemsize
        offsets = events.offsets[first:last][fits]
        records = messages.turned(type_name, bytes_of(self._data, offsets, wire.itemsize))
        known = records[messages.FINGERPRINT] == messages.fingerprint_of(type_name)
        stamps_us = events.stamps_us[first:last][fits]
        return (stamps_us, records) if known.all() else (stamps_us[known], records[known])

    def decode(self, channel: str) -> list[Any]:
        """Messages of any limber channel as objects, one by one (slow; for events with strings)."""
        return list(self.each(channel))

    def each(self, channel: str) -> Iterator[Any]:
        """The same, a few in memory at a time."""
        for start in range(0, len(self.channels.get(channel, ())), OBJECTS):
            yield from (message for _, message in self.objects(channel, start, start + OBJECTS))

    def objects(self, channel: str, first: int, last: int | None) -> list[tuple[int, Any]]:
        """Of the messages first to last (not included) of any limber channel those of this version:
        time stamp in µs, and message.
        """
        type_name = self.type_of(channel)
        if type_name is None:
            raise InputError(
                f"channel '{channel}' is not one of limber's: " + ", ".join(messages.channels())
            )
        events = self.channels.get(channel, NO_EVENTS)
        decoded = []
        for data, stamp_us in zip(
            self.raw(channel, first, last), events.stamps_us[first:last].tolist(), strict=True
        ):
            try:
                decoded.append((stamp_us, messages.decode(type_name, data)))
            except ValueError:
                continue  # another type on this channel; counted by undecodable()
        return decoded

    def undecodable(self, channel: str) -> int:
        """Messages that are not of the channel's type, of another version of it, or damaged."""
        type_name, count = self.type_of(channel), len(self.channels[channel])
        if type_name is None:
            return count
        if messages.dtype_of(type_name) is not None:
            return count - int(np.count_nonzero(self._good(channel)))
        return count - sum(1 for _ in self.each(channel))

    def _good(self, channel: str) -> Flags:
        """Which messages of a fixed-size channel are of this version."""
        events = self.channels[channel]
        good: Flags = events.sizes == self._wire(channel).itemsize
        starts = bytes_of(self._data, events.offsets[good], 8).view(">u8")[:, 0]
        good[good] = starts == messages.fingerprint_of(self._type(channel))
        return good

    def _type(self, channel: str) -> str:
        """Of one of limber's channels."""
        type_name = self.type_of(channel)
        assert type_name is not None
        return type_name

    def _wire(self, channel: str) -> np.dtype[np.void]:
        """Layout of a fixed-size channel."""
        wire = messages.dtype_of(self._type(channel))
        assert wire is not None
        return wire

    def lost(self, channel: str) -> int:
        """Messages that never arrived, by gaps in the sequence number (the first field of each) of
        each sender. Requests and answers have no numbers that would tell: 0.
        """
        return self._gaps(channel)[0]

    def jumps(self, channel: str) -> int:
        """Gaps that are no losses: a damaged number, or another sender's."""
        return self._gaps(channel)[1]

    def _gaps(self, channel: str) -> tuple[int, int]:
        row = messages.channels().get(channel)
        if row is None or not row.numbered:
            return 0, 0
        try:
            number, sender = _number_and_sender(row.type_name)
            records = self.fields(channel, *filter(None, (number, sender)))
        except InputError:
            return 0, 0  # of another version: nothing in it is known
        numbers = records[number]
        senders = np.zeros(len(numbers)) if sender is None else records[sender]
        parts = [numbers[senders == s] for s in np.unique(senders)]
        return sum(map(count_gaps, parts)), sum(map(count_jumps, parts))

    def stamps_s(self, channel: str) -> np.ndarray:
        return self.channels[channel].stamps_us * 1e-6

    @property
    def first_us(self) -> int:
        """Time stamp of the first message."""
        return int(min(found.stamps_us.min() for found in self.channels.values()))

    @property
    def length_s(self) -> float:
        """From the first message to the last."""
        last_us = max(found.stamps_us.max() for found in self.channels.values())
        return float((last_us - self.first_us) * 1e-6)

    def chosen(self, wanted: Sequence[str]) -> list[str]:
        """These channels, or all if none is named; InputError for one that is not there."""
        for name in wanted:
            if name not in self.channels:
                raise InputError(
                    f"no channel '{name}' in this log: {', '.join(sorted(self.channels))}"
                )
        return list(wanted) or sorted(self.channels)

    @property
    def size_bytes(self) -> int:
        return len(self._data)

    @property
    def skipped_bytes(self) -> int:
        return self._damage.skipped_bytes

    @property
    def truncated_bytes(self) -> int:
        return self._damage.truncated_bytes

    @property
    def cut_off(self) -> bool:
        """It ends within an event, or within a compressed block."""
        return self._damage.truncated_bytes + self._damage.packed_truncated_bytes > 0

    def damage(self) -> str:
        """One sentence on what could not be read; empty if everything was."""
        return str(self._damage)


def _number_and_sender(type_name: str) -> tuple[str, str | None]:
    """The fields that count a sender's messages and that name its run, if there is one."""
    names = messages.message_class(type_name).__slots__
    return names[0], next((name for name in messages.SENDERS if name in names), None)


def time_s(records: np.ndarray) -> np.ndarray:
    """Arm time of messages, s."""
    return records["time_ns"] * 1e-9


def count_gaps(sequence: np.ndarray) -> int:
    """Missing numbers. A number that goes back is a new run of the sender, not a loss."""
    steps = np.diff(sequence)[~_far(sequence)]
    return int((steps[steps > 1] - 1).sum())


def count_jumps(sequence: np.ndarray) -> int:
    """Steps, either way, by more than can be lost."""
    return int(np.count_nonzero(_far(sequence)))


def _far(sequence: np.ndarray) -> np.ndarray:
    return np.abs(np.diff(np.asarray(sequence, float))) > MOST_LOST  # integers may wrap around


def log_file(path: Path) -> Path:
    """`path` itself, or the log in it if it is the folder of a run."""
    if not path.is_dir():
        return existing_file(path, "log, or the folder of a run,")
    found = next((path / name for name in LOG_NAMES if (path / name).is_file()), None)
    if found is None:
        names = " or ".join(LOG_NAMES)
        raise InputError(f"{path} holds no {names}: give a log, or the folder of a run")
    return found
