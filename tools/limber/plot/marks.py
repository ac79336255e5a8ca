"""What is marked on the time axes of charts: the events of a run, and when no law ran."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from limber.log.events import Event, Names, events
from limber.log.reader import Log, time_s
from limber.log.rows import active

MARKED = ("mode", "goal", "gains", "push", "contact", "drives")
SAME_S = 0.005
BEFORE_S = 0.02  # a driver's fault comes before the controller's mode


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


def spans(log: Log, marks: list[Mark]) -> list[Span]:
    """Stretches in which the controller was not ACTIVE; bad if something went wrong in them."""
    status = log.read("CONTROLLER_STATUS")
    if not len(status):
        return []
    under_law = active(status)
    t, changes = time_s(status), np.flatnonzero(np.diff(under_law)) + 1
    edges = [0, *(int(row) for row in changes), len(status) - 1]
    found = []
    for start, end in pairwise(edges):
        begin_s, end_s = float(t[start]), float(t[end])
        bad = any(mark.bad and begin_s - BEFORE_S < mark.time_s < end_s for mark in marks)
        if not under_law[start] and begin_s < end_s:
            found.append(Span(begin_s, end_s, bad))
    return found
