"""Reads LCM event logs: whole channels at once, damaged files as far as they are good."""

from collections.abc import Collection, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib import recfunctions

from limber import messages
from limber.errors import InputError
from limber.log.event_file import Damage, contents, events
from limber.log.event_index import NO_EVENTS, bytes_of, index
from limber.paths import existing_file

LOG_NAMES = ("run.lcmlog", "run.lcmlog.zst")  # what a run leaves, plain or compressed
PIECE = 1 << 14  # messages read at a time where only some fields count


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

    def whole_events(self, channels: Collection[str]) -> Iterator[tuple[int, bytes]]:
        """Time stamp in µs and bytes with header of the whole events, in the order of the file."""
        for begin, _, _, stamp_us, channel, end in events(self._data, Damage()):
            if channel in channels:
                yield stamp_us, self._data[begin:end]

    def in_order(self, channels: Collection[str]) -> Iterator[tuple[int, str, bytes]]:
        """Time stamp in µs, channel and data of the whole events, in the order of the file."""
        for _, start, size, stamp_us, channel, _ in events(self._data, Damage()):
            if channel in channels:
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
        if wire is None:
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
        return [message for _, message in self.objects(channel, 0, None)]

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
        type_name = self.type_of(channel)
        if type_name is None:
            return len(self.channels[channel])
        fingerprint = messages.fingerprint_of(type_name).to_bytes(8, "big")
        offsets = self.channels[channel].offsets.tolist()
        starts = (self._data[offset : offset + 8] for offset in offsets)
        return sum(start != fingerprint for start in starts)

    def lost(self, channel: str) -> int:
        """Messages that never arrived, by gaps in the sequence number (the first field of each) of
        each sender. Requests and answers have no numbers that would tell: 0.
        """
        row = messages.channels().get(channel)
        if row is None or not row.numbered:
            return 0
        try:
            number, sender = _number_and_sender(row.type_name)
            records = self.fields(channel, *filter(None, (number, sender)))
        except InputError:
            return 0  # of another version: nothing in it is known
        numbers = records[number]
        if sender is None:
            return count_gaps(numbers)
        return sum(count_gaps(numbers[records[sender] == s]) for s in np.unique(records[sender]))

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
    steps = np.diff(sequence)
    return int((steps[steps > 1] - 1).sum())


def log_file(path: Path) -> Path:
    """`path` itself, or the log in it if it is the folder of a run."""
    if not path.is_dir():
        return existing_file(path, "log, or the folder of a run,")
    found = next((path / name for name in LOG_NAMES if (path / name).is_file()), None)
    if found is None:
        names = " or ".join(LOG_NAMES)
        raise InputError(f"{path} holds no {names}: give a log, or the folder of a run")
    return found
