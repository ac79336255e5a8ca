"""Which rows of a channel something happens in."""

from collections.abc import Iterator

import numpy as np

from limber.arrays import Flags, Records
from limber.messages import message_class


def active(status: Records) -> Flags:
    """True where a control law runs, for each row of CONTROLLER_STATUS."""
    acts: Flags = status["mode"] == message_class("controller_status_t").MODE_ACTIVE
    return acts


def stretches(t: np.ndarray, acts: np.ndarray, pause_s: float) -> Iterator[slice]:
    """Rows in which something acts; pauses of up to `pause_s` are bridged. `t` in s."""
    rows = np.flatnonzero(acts)
    if not len(rows):
        return
    breaks = np.flatnonzero(np.diff(t[rows]) > pause_s)
    for first, last in zip([0, *(breaks + 1)], [*breaks, len(rows) - 1], strict=True):
        yield slice(int(rows[first]), int(rows[last]) + 1)
