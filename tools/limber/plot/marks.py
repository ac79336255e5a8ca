"""What is marked on the time axes of charts: the events of a run, and when no law ran."""

from dataclasses import dataclass

import numpy as np

from limber.log.events import Event, Names, events
from limber.log.reader import Log, time_s
from limber.messages import constants

MARKED = ("mode", "goal", "gains", "push", "contact", "drives")
SAME_S = 0.005


@dataclass(frozen=True)
class Mark:
    """`number` counts the marks of a run; a row of its list of events may tell more than one."""

    number: int
    time_s: float
    text: str
    bad: bool


@dataclass(frozen=True)
class Span:
    """No law ran from `begin_s` to `end_s`; `bad` if because of a fault."""

    begin_s: float
    end_s: float
    bad: bool


def marks(log: Log, names: Names, begin_s: float) -> list[Mark]:
    """Requests that were taken, mode changes, pushes, contacts and all that went wrong."""
    found: list[tuple[float, list[str], bool]] = []
    for event in events(log, names):
        if event.time_s < begin_s or not (event.bad or _worth(event)):
            continue
        if found and event.time_s - found[-1][0] < SAME_S and found[-1][2] == event.bad:
            found[-1][1].append(event.text)
        else:
            found.append((event.time_s, [event.text], event.bad))
    return [Mark(i, at, "; ".join(texts), bad) for i, (at, texts, bad) in enumerate(found, 1)]


def _worth(event: Event) -> bool:
    return event.text.startswith(MARKED)


def spans(log: Log) -> list[Span]:
    """Stretches in which the controller was not ACTIVE."""
    status = log.read("CONTROLLER_STATUS")
    words = {name: number for number, name in constants("controller_status_t", "MODE_").items()}
    bad = (words["FAULT"], words["ESTOP"], words["SOFT_STOP"])
    t, mode = time_s(status), status["mode"]
    if not len(status):
        return []
    starts = [0, *(np.flatnonzero(np.diff(mode)) + 1)]
    ends = [*starts[1:], len(status) - 1]
    return [
        Span(float(t[start]), float(t[end]), int(mode[start]) in bad)
        for start, end in zip(starts, ends, strict=True)
        if mode[start] != words["ACTIVE"]
    ]
