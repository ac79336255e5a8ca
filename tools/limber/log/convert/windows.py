"""A log in pieces that fit into memory: what a converter receives."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from limber import messages
from limber.log.convert.columns import NUM_JOINTS
from limber.log.events import Event
from limber.log.reader import Log

WINDOW_BYTES = 1 << 25


@dataclass(frozen=True)
class Batch:
    """Messages of a channel. `messages`: records of a type of fixed size, else objects."""

    channel: str
    type_name: str
    stamps_us: np.ndarray
    messages: np.ndarray | list[Any]

    @property
    def fixed(self) -> bool:
        return isinstance(self.messages, np.ndarray)


class Writer(Protocol):
    """One format. What it writes is complete after close()."""

    def begin(self, story: Sequence[Event], arm_time_zero_us: int) -> None:
        """The story of the run; the time stamp at which arm time was zero."""

    def write(self, window: list[Batch]) -> None:
        """The next window: all its channels, each in its order."""

    def close(self) -> None: ...


def windows(log: Log, channels: Sequence[str]) -> Iterator[tuple[int, list[Batch]]]:
    """The channels' messages piece by piece, and how many bytes of the log have been read."""
    offsets = {name: np.asarray(log.channels[name].offsets) for name in channels}
    for start in range(0, log.size_bytes, WINDOW_BYTES):
        end = min(start + WINDOW_BYTES, log.size_bytes)
        window = []
        for name in channels:
            first, last = (int(i) for i in np.searchsorted(offsets[name], (start, end)))
            if first < last:
                window.append(_batch(log, name, first, last))
        yield end, [batch for batch in window if len(batch.stamps_us)]


def _batch(log: Log, channel: str, first: int, last: int) -> Batch:
    type_name = log.type_of(channel)
    assert type_name is not None
    if messages.dtype_of(type_name) is not None:
        return Batch(channel, type_name, *log.records(channel, first, last))
    found = log.objects(channel, first, last)
    stamps = np.asarray([stamp for stamp, _ in found], np.int64)
    return Batch(channel, type_name, stamps, [message for _, message in found])


def joint_names(log: Log, otherwise: Sequence[str]) -> tuple[tuple[str, ...], bool]:
    """The joints' names as identifiers, and whether the log holds several arms: then the first
    counts. Named by ROBOT_INFO, else as given, else numbered.
    """
    told = list(dict.fromkeys(tuple(info.joints) for info in log.each("ROBOT_INFO")))
    names = told[0] if told else tuple(otherwise)
    if not names:
        counts = [_first_count(log, name) for name in ("JOINT_STATE", "CONTROLLER_STATUS")]
        names = tuple(f"joint{i + 1}" for i in range(max(counts)))
    return identifiers(names), len(told) > 1


def _first_count(log: Log, channel: str) -> int:
    if channel not in log.channels:
        return 0
    _, found = log.records(channel, 0, 1)
    return min(max(int(found["num_joints"][0]), 0), NUM_JOINTS) if len(found) else 0


def identifiers(names: Sequence[str]) -> tuple[str, ...]:
    """Letters, digits and _ only, no digit first, each once: what every tool accepts in a name."""
    made: list[str] = []
    for i, name in enumerate(names):
        word = re.sub(r"\W", "_", name, flags=re.ASCII)
        word = word if re.match(r"[A-Za-z_]", word) else f"joint_{word}"
        once, number = word, i + 1
        while once in made:
            once, number = f"{word}_{number}", number + 1
        made.append(once)
    return tuple(made)
