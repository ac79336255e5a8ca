"""Where the events of a log lie, by channel.

In an undamaged log every sync word begins an event that ends where the next one begins, so all are
found at once, by numpy. In any other log they are found one after the other (event_file.py), with
the same result.
"""

import mmap
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from limber.log.event_file import (
    HEADER,
    MAX_CHANNEL_BYTES,
    MAX_DATA_BYTES,
    SYNC,
    Damage,
    events,
)

PIECE = 1 << 24  # bytes that are searched at a time
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

    def between(self, begin: int, end: int) -> "Events":
        """Those whose data begin in this part of the file."""
        rows = slice(*np.searchsorted(self.offsets, [begin, end]))
        return Events(self.offsets[rows], self.sizes[rows], self.stamps_us[rows])


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
    for length in np.unique(names):
        rows = np.flatnonzero(names == length)
        texts = bytes_of(data, begins[rows] + HEADER.size, int(length)).view(f"V{length}")[:, 0]
        while len(rows):
            name = texts[0].tobytes()
            if not name.isascii():
                return None
            same = texts == texts[0]
            chosen = rows[same]
            found[name.decode("ascii")] = Events(starts[chosen], sizes[chosen], stamps_us[chosen])
            rows, texts = rows[~same], texts[~same]
    return dict(sorted(found.items(), key=lambda item: item[1].offsets[0]))


def _sync_words(data: np.ndarray) -> np.ndarray:
    """Where they begin, in order; also those that a message happens to contain."""
    pieces = []
    for at in range(0, len(data), PIECE):
        places = at + np.flatnonzero(data[at : at + PIECE] == SYNC[0])
        places = places[places <= len(data) - len(SYNC)]
        for i in range(1, len(SYNC)):
            places = places[data[places + i] == SYNC[i]]
        pieces.append(places)
    return np.concatenate(pieces) if pieces else np.empty(0, np.int64)


def bytes_of(data: mmap.mmap | np.ndarray, begins: np.ndarray, size: int) -> NDArray[np.uint8]:
    """The `size` bytes from each of these places on, uint8, one row a place."""
    overlapping = np.ndarray(max(len(data) - size + 1, 0), f"V{size}", data, strides=(1,))
    found: NDArray[np.uint8] = overlapping[begins].view(np.uint8).reshape(len(begins), size)
    return found
