"""A log has no checksum: damaged bytes within a message show only in its numbers."""

import numpy as np

from limber.arrays import Flags, Records

UNIT = 1e-3  # how far from 1 a quaternion's length may be


def sound(records: Records) -> Records:
    """The messages whose numbers are all finite and whose attitude, if any, is one."""
    kept: Records = records[~(_damaged(records) | _unknown(records))]
    return kept


def damaged(records: Records) -> int:
    """Messages with numbers that cannot be. An attitude that is all zero is none: nobody has
    computed one before the first usable state of the arm."""
    return int(np.count_nonzero(_damaged(records) & ~_unknown(records)))


def _damaged(records: Records) -> Flags:
    bad = np.zeros(len(records), dtype=bool)
    if not len(records):
        return bad
    for name in records.dtype.names or ():
        values = records[name].reshape(len(records), -1)
        if values.dtype.kind == "f":
            bad |= ~np.isfinite(values).all(axis=1)
        if name == "quat_BT":
            with np.errstate(over="ignore"):
                bad |= ~(np.abs(np.linalg.norm(values, axis=1) - 1) < UNIT)
    return bad


def _unknown(records: Records) -> Flags:
    if not len(records) or "quat_BT" not in (records.dtype.names or ()):
        return np.zeros(len(records), dtype=bool)
    zero: Flags = (records["quat_BT"] == 0).all(axis=1)
    return zero
