"""Where one run ends in a log and the next begins: a recorder goes on while the stack is started
anew, or somebody has put two logs into one file.

A run ends where arm time goes back or the driver's session changes, for good: single messages that
do not fit are somebody else's, and end nothing.
"""

from collections.abc import Iterator

import numpy as np

from limber.log.event_index import Events

NEIGHBOURS = 5  # messages on either side that a break is judged by
BY = ("JOINT_STATE", "CONTROLLER_STATUS", "SIM_TRUTH")  # the first that a log has tells


def breaks(time_ns: np.ndarray, session: np.ndarray | None) -> Iterator[int]:
    """Rows that a new run begins with, except the first."""
    changed = np.diff(time_ns) < 0
    if session is not None:
        changed |= np.diff(session) != 0
    last = 0
    for row in np.flatnonzero(changed) + 1:
        before, after = slice(max(row - NEIGHBOURS, 0), row), slice(row, row + NEIGHBOURS)
        back = _but_one(time_ns[after])[1] < _but_one(time_ns[before])[0]
        other = session is not None and _other(session[before], session[after])
        if (back or other) and (not last or row - last >= NEIGHBOURS):
            last = int(row)
            yield last


def _but_one(values: np.ndarray) -> tuple[int, int]:
    """Least and greatest of them without the one that is furthest off on that side."""
    ordered = np.sort(values)
    return int(ordered[min(1, len(ordered) - 1)]), int(ordered[max(len(ordered) - 2, 0)])


def _other(before: np.ndarray, after: np.ndarray) -> bool:
    """All of one session, but for one message at most, then all of another."""
    (old, last), (new, end) = _but_one(before), _but_one(after)
    return old == last and new == end and old != new


def border(channels: dict[str, Events], last: int, first: int) -> int:
    """Where the second of two runs begins in the file, between the message at `last` of the one and
    that at `first` of the other: at the greatest step of the time stamps.
    """
    parts = []
    for found in channels.values():
        rows = slice(*np.searchsorted(found.offsets, [last, first + 1]))
        parts.append(np.stack([found.offsets[rows], found.stamps_us[rows]]))
    places, stamps_us = np.concatenate(parts, axis=1)
    order = np.argsort(places)
    steps = np.abs(np.diff(stamps_us[order]))
    return int(places[order][1 + np.argmax(steps)])
