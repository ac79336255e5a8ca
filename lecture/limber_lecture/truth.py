"""True motion and controller status in a run, refused if more than the law acted in it."""

import numpy as np

from limber import messages
from limber.errors import RunError
from limber.log.reader import Log, time_s
from limber.log.rows import active

__all__ = ["RAMP", "Log", "joints", "motion", "status", "time_s"]

RAMP = frozenset({"RAMP"})  # gains on their way, or a new law taking over


def motion(log: Log, start_s: float, end_s: float) -> np.ndarray:
    """Rows of SIM_TRUTH, one a control period, from `start_s` up to `end_s` of arm time."""
    return between(log, "SIM_TRUTH", start_s, end_s)


def status(log: Log, start_s: float, end_s: float, allowed: frozenset[str] = RAMP) -> np.ndarray:
    """Rows of CONTROLLER_STATUS, one every fifth cycle. Refuses a run in which a limit was active
    that is not `allowed`, or in which the controller refused a request.
    """
    rows = between(log, "CONTROLLER_STATUS", start_s, end_s)
    if not active(rows).all():
        raise RunError(f"{log.path}: the arm is not active all the time")
    names = messages.bit_names(
        "controller_status_t", "LIMIT_", int(np.bitwise_or.reduce(rows["limits"]))
    )
    if others := [name for name in names if name not in allowed]:
        raise RunError(f"{log.path}: limits act: {', '.join(others)}")
    if refused := rows["requests_refused"].max():
        raise RunError(f"{log.path}: the controller refused {refused} requests")
    return rows


def joints(rows: np.ndarray, name: str = "q") -> np.ndarray:
    """A field of all joints without what fills it up to 16."""
    return rows[name][:, : rows["num_joints"][0]]


def between(log: Log, channel: str, start_s: float, end_s: float) -> np.ndarray:
    """The messages of a channel from `start_s` up to `end_s` of arm time."""
    rows = log.read(channel)
    t = time_s(rows)
    first, last = np.searchsorted(t, [start_s - 1e-6, end_s - 1e-6])
    chosen = rows[first:last]
    if len(chosen) == 0 or t[-1] < end_s - 0.01:
        raise RunError(f"{log.path}: {channel} ends before {end_s:g} s")
    return chosen
