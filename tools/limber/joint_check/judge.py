"""Which joint a hand has turned, and which way: plain numbers in, a finding out.

What counts is the motors' angles, to which the signs of robot.yaml belong; an encoder on the link
has to go along.

A joint's change counts from where it was when the arm had come to rest, in shares of the amount
that it is to be turned by: so rad and m compare. A joint that sags is followed slowly.
"""

from collections import deque
from dataclasses import dataclass
from enum import Enum

import numpy as np

from limber.arrays import Flags, Floats

STILL_S = 0.5  # at rest: in that time no joint changes by more than ...
STILL = 0.05  # ... this share of its amount
SAG_PER_S = 0.05  # shares of the amount, by which the start follows a joint that is not turned
LONGEST_S = 0.1  # between two readings; a longer pause tells nothing of sagging
OTHER = 1 / 3  # of the farthest change: what moves farther has been moved, too
LASTS_S = 0.2  # so long a finding has to hold; one reading is none
SHARE_OF_RANGE = 1 / 3  # a joint is asked for no more


class Verdict(Enum):
    OK = "ok"
    SIGN = "sign"  # the right joint, the wrong way
    EXCHANGED = "exchanged"  # another joint's motor
    LINK = "link encoder"  # the joint's motor, but its link's encoder reads another angle
    SEVERAL = "several"  # nothing can be concluded


@dataclass(frozen=True)
class Finding:
    """`moved`: change of `joints[0]`, the one that moved farthest, rad or m, towards positive."""

    verdict: Verdict
    moved: float
    joints: tuple[int, ...]


def amounts(slides: Flags, ranges: Floats, angle: float, length: float) -> Floats:
    """By how much each joint is to be turned, rad or m; less where its range is small."""
    found: Floats = np.minimum(np.where(slides, length, angle), SHARE_OF_RANGE * ranges)
    return found


def direction(q: float, low: float, high: float, amount: float) -> int:
    """1, or -1 where only the negative direction has room."""
    return -1 if high - q < amount <= q - low else 1


class Step:
    """One joint's turn: waits until the arm is at rest, then for the hand.

    `joint`: its index; `way`: 1 or -1, the direction asked for (0: to be chosen once it is at
    rest); `amounts`: of each joint. `q`: the newest readings, not finite where there is none.
    """

    def __init__(self, joint: int, way: int, amounts: Floats) -> None:
        self.joint, self.way = joint, way
        self.amounts = np.asarray(amounts, float)
        self.missing: tuple[int, ...] = ()  # joints without a reading
        self.moving: tuple[int, ...] = ()  # joints whose rest is awaited
        self._window: deque[tuple[float, Floats]] = deque()
        self._start: Floats | None = None
        self._apart = self._start_apart = np.zeros(len(self.amounts))
        self.q = np.full(len(self.amounts), np.nan)
        self._time_s = -np.inf
        self._first: tuple[float, Finding] | None = None

    @property
    def at_rest(self) -> bool:
        """The arm has come to rest: now the joint is to be turned."""
        return self._start is not None

    @property
    def change(self) -> Floats:
        """Of each joint since the step began, rad or m; not finite where nothing is known."""
        change: Floats = self.q - (self.q if self._start is None else self._start)
        return change

    @property
    def shares(self) -> Floats:
        """The same in shares of the amounts."""
        shares: Floats = self.change / self.amounts
        return shares

    def take(
        self, time_s: float, q: Floats, fresh: Flags, apart: Floats | None = None
    ) -> Finding | None:
        """Readings of all joints; those that are not fresh or not finite do not count. `apart`: of
        the link's encoders, by how much they read more than the motors'.
        """
        if apart is not None:
            self._apart = np.asarray(apart, float)
        self.q = np.where(np.asarray(fresh, bool) & np.isfinite(q), q, np.nan)
        passed_s = time_s - self._time_s
        self._time_s = time_s
        self.missing = tuple(int(i) for i in np.flatnonzero(np.isnan(self.q)))
        if self.missing or passed_s <= 0.0:
            self._window.clear()
            self._first = None
            return None
        if self._start is None:
            self._await_rest(time_s)
            return None
        self._follow_sag(passed_s)
        return self._lasting(time_s, self._seen())

    def _await_rest(self, time_s: float) -> None:
        self._window.append((time_s, self.q))
        while time_s - self._window[0][0] > STILL_S and time_s - self._window[1][0] >= STILL_S:
            self._window.popleft()
        readings = np.array([q for _, q in self._window])
        spread = np.ptp(readings, axis=0) / self.amounts
        self.moving = tuple(int(i) for i in np.flatnonzero(spread > STILL))
        if not self.moving and time_s - self._window[0][0] >= STILL_S:
            self._start = readings.mean(axis=0)
            self._start_apart = self._apart

    def _follow_sag(self, passed_s: float) -> None:
        assert self._start is not None
        share = SAG_PER_S * min(passed_s, LONGEST_S)
        most = np.where(np.abs(self.shares) <= OTHER, share * self.amounts, 0.0)
        self._start = self._start + np.clip(self.change, -most, most)

    def _seen(self) -> Finding | None:
        """What this reading alone tells."""
        shares = np.abs(self.shares)
        order = np.argsort(-shares)
        farthest = shares[order[0]]
        if farthest < 1.0:
            return None
        moved = tuple(int(i) for i in order if shares[i] > OTHER * farthest)
        change = float(self.change[moved[0]])
        if len(moved) > 1:
            return Finding(Verdict.SEVERAL, change, moved)
        if moved[0] != self.joint:
            return Finding(Verdict.EXCHANGED, change, moved)
        if not change * self.way > 0:
            return Finding(Verdict.SIGN, change, moved)
        apart = abs(self._apart[self.joint] - self._start_apart[self.joint])
        right = apart <= OTHER * abs(change)
        return Finding(Verdict.OK if right else Verdict.LINK, change, moved)

    def _lasting(self, time_s: float, seen: Finding | None) -> Finding | None:
        if seen is None:
            self._first = None
        elif self._first is None or not _alike(self._first[1], seen):
            self._first = time_s, seen
        elif time_s - self._first[0] >= LASTS_S:
            return seen
        return None


def _alike(a: Finding, b: Finding) -> bool:
    return a.verdict is b.verdict and (a.verdict is Verdict.SEVERAL or a.joints == b.joints)
