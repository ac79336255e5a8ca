"""Where the events of a log lie, by channel.

In an undamaged log every sync word begins an event that ends where the next one begins, so all are
found at once, by numpy. In any other log they are found one after the other (event_file.py), with
the same result.
"""

import mmap
from dataclasses import dataclass

import numpy as np

from limber.log.event_file import (
    HEADER,
    MAX_CHANNEL_BYTES,
    MAX_DATA_BYTES,
    SYNC,
    Damage,
    events,
)

PIECE = 1 << 23  # pairs of bytes that are searched at a time
PAIRS = np.array([SYNC[:2], SYNC[1:3]]).view(np.uint16).reshape(2, 1)
FIELDS = np.dtype(
    [("sync", "S4"), ("number", ">i8"), ("stamp_us", ">i8"), ("channel", ">i4"), ("data", ">i4")]
)


@dataclass(frozen=True)
class Events:
    """Where one channel's events lie in the file; int64 each."""

    offsets: np.ndarray
    sizes: np.ndarray
    stamps_us: np.ndarray

    def __len__(self) -> int:
        return len(self.offsets)


NO_EVENTS = Events(*np.empty((3, 0), np.int64))


def index(data: mmap.mmap, damage: Damage) -> dict[str, Events]:
    """All whole events, channels in the order of their first; what is left out is added to
    `damage`.
    """
    found = _all_at_once(np.frombuffer(data, np.uint8))
    return _one_by_one(data, damage) if found is None else found


def _one_by_one(data: mmap.mmap, damage: Damage) -> dict[str, Events]:
    rows: dict[str, list[tuple[int, int, int]]] = {}
    for _, start, size, stamp_us, channel, _ in events(data, damage):
        rows.setdefault(channel, []).append((start, size, stamp_us))
    return {name: Events(*np.array(found, np.int64).T) for name, found in rows.items()}


def _all_at_once(data: np.ndarray) -> dict[str, Events] | None:
    """None unless each sync word begins an event that the next one, or the end, follows."""
    begins = _sync_words(data)
    if len(begins) == 0 or begins[0] != 0 or begins[-1] + HEADER.size > len(data):
        return None
    headers = bytes_of(data, begins, HEADER.size).view(FIELDS)[:, 0]
    names, sizes = (headers[key].astype(np.int64) for key in ("channel", "data"))
    sane = (names > 0) & (names <= MAX_CHANNEL_BYTES) & (sizes >= 0) & (sizes <= MAX_DATA_BYTES)
    starts = begins + HEADER.size + names
    if not sane.all() or not np.array_equal(starts + sizes, np.append(begins[1:], len(data))):
        return None
    stamps_us = headers["stamp_us"].astype(np.int64)
    found = {}
    for length in np.flatnonzero(np.bincount(names)).tolist():
        rows = np.flatnonzero(names == length)
        texts = bytes_of(data, begins[rows] + HEADER.size, length).view(f"S{length}")[:, 0]
        while len(rows):
            name = texts[0].ljust(length, b"\0")  # numpy takes them off
            if not name.isascii():
                return None
            same = texts == texts[0]
            chosen = rows[same]
            found[name.decode("ascii")] = Events(starts[chosen], sizes[chosen], stamps_us[chosen])
            rows, texts = rows[~same], texts[~same]
    return dict(sorted(found.items(), key=lambda item: item[1].offsets[0]))


def _sync_words(data: np.ndarray) -> np.ndarray:
    """Where they begin, in order; also those that a message happens to contain.

    Of the bytes in pairs, one is the first two of a sync word at an even place, or the middle two of
    one at an odd place; few others are. Numpy compares pairs as fast as bytes.
    """
    pairs = data[: len(data) // 2 * 2].view(np.uint16)
    found = [np.empty(0, np.int64)]
    for at in range(0, len(pairs), PIECE):
        found.append(at + np.flatnonzero((pairs[at : at + PIECE] == PAIRS).any(axis=0)))
    places = 2 * np.concatenate(found)
    places -= data[places] == SYNC[1]
    places = places[(places >= 0) & (places <= len(data) - len(SYNC))]
    return places[bytes_of(data, places, len(SYNC)).view("S4")[:, 0] == SYNC]


def bytes_of(data: mmap.mmap | np.ndarray, begins: np.ndarray, size: int) -> np.ndarray:
    """The `size` bytes from each of these places on, uint8, one row a place."""
    overlapping = np.ndarray(max(len(data) - size + 1, 0), f"V{size}", data, strides=(1,))
    return overlapping[begins].view(np.uint8).reshape(len(begins), size)
