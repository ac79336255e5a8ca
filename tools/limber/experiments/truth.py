"""What the log of a run says of the arm, and that nothing but the law was at work in it."""

import numpy as np

from limber import messages
from limber.errors import RunError
from limber.logs import Log

MODE_ACTIVE = 4
RAMP = frozenset({"RAMP"})  # gains on their way, or a new law taking over


def motion(log: Log, start_s: float, end_s: float) -> np.ndarray:
    """Rows of SIM_TRUTH, one a control period, from `start_s` up to `end_s` of arm time."""
    return _between(log, "SIM_TRUTH", start_s, end_s)


def status(log: Log, start_s: float, end_s: float, allowed: frozenset[str] = RAMP) -> np.ndarray:
    """Rows of CONTROLLER_STATUS, one every fifth cycle. Refuses a run in which a limit was active
    that is not `allowed`, or in which the controller did not do what it was asked for.
    """
    rows = _between(log, "CONTROLLER_STATUS", start_s, end_s)
    if not (rows["mode"] == MODE_ACTIVE).all():
        raise RunError(f"{log.path}: the arm is not active all the time")
    names = messages.bit_names(
        "controller_status_t", "LIMIT_", int(np.bitwise_or.reduce(rows["limits"]))
    )
    if others := [name for name in names if name not in allowed]:
        raise RunError(f"{log.path}: limits act: {', '.join(others)}")
    if refused := rows["requests_refused"].max():
        raise RunError(f"{log.path}: the controller refused {refused} requests")
    return rows


def seconds(rows: np.ndarray) -> np.ndarray:
    return rows["time_ns"] * 1e-9


def joints(rows: np.ndarray, name: str = "q") -> np.ndarray:
    """A field of all joints without what fills it up to 16."""
    return rows[name][:, : rows["num_joints"][0]]


def _between(log: Log, channel: str, start_s: float, end_s: float) -> np.ndarray:
    rows = log.read(channel)
    t = seconds(rows)
    chosen = rows[(t >= start_s - 1e-6) & (t < end_s - 1e-6)]
    if len(chosen) == 0 or t[-1] < end_s - 0.01:
        raise RunError(f"{log.path}: {channel} ends before {end_s:g} s")
    return chosen
