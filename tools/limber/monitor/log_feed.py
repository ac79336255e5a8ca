"""Messages of a recorded run at a place in it that moves: play, pause, speed, jump."""

import numpy as np

from limber.errors import InputError
from limber.log.reader import Log, time_s
from limber.monitor.feed import NEVER_S, NUMERIC, WITH_STRINGS, Batch, empty

SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0, 5.0)


class LogFeed:
    """Times are arm time, s. A log of several driver sessions plays the longest: only within one
    session does arm time order the messages.
    """

    def __init__(self, log: Log, history_s: float) -> None:
        self.newest: dict[str, np.void] = {}
        self.playing = False
        self.speed = 1.0
        self._history_s = history_s
        self._log = log
        self._session, self._sessions = _longest_session(log)
        self._arrays = {channel: self._of_session(channel) for channel in NUMERIC}
        self._times = {channel: time_s(rows) for channel, rows in self._arrays.items()}
        state = self._times["JOINT_STATE"]
        self.start_s, self.end_s = float(state[0]), float(state[-1])
        self.position_s = self.start_s
        self._troubles = self._find_troubles()
        self._taken_s = -NEVER_S
        self._jumped = True

    def _of_session(self, channel: str) -> np.ndarray:
        if channel not in self._log.channels:
            return empty(channel)
        rows = self._log.read(channel)
        if "session" in (rows.dtype.names or ()):
            rows = rows[rows["session"] == self._session]
        return rows[np.argsort(rows["time_ns"], kind="stable")]

    def advance(self, passed_s: float) -> None:
        """Moves on by wall time, and stops at the end."""
        if not self.playing:
            return
        self.position_s = min(self.position_s + passed_s * self.speed, self.end_s)
        self.playing = self.position_s < self.end_s

    def jump(self, time_s: float) -> None:
        self.position_s = float(np.clip(time_s, self.start_s, self.end_s))
        self._jumped = True

    def take(self) -> Batch:
        """After a jump: what happened within the history that the charts show."""
        since = self.position_s - self._history_s if self._jumped else self._taken_s
        batch = Batch(restart=self._jumped)
        for channel, rows in self._arrays.items():
            first, end = np.searchsorted(
                self._times[channel], (since, self.position_s), side="right"
            )
            if end > first:
                batch.arrays[channel] = rows[first:end]
            if end > 0:
                self.newest[channel] = rows[end - 1]
            else:
                self.newest.pop(channel, None)
        for channel in WITH_STRINGS:
            found = self._log.decode(channel) if self._jumped else []
            if found:
                batch.objects[channel] = [m for m in found if m.time_ns * 1e-9 <= self.position_s]
        self._taken_s, self._jumped = self.position_s, False
        return batch

    def age_s(self, channel: str) -> float:
        """Before the place in the log, so that a process that had died shows as dead."""
        newest = self.newest.get(channel)
        return NEVER_S if newest is None else self.position_s - float(newest["time_ns"]) * 1e-9

    def troubles(self) -> list[str]:
        return self._troubles

    def _find_troubles(self) -> list[str]:
        found = [self._log.damage()] if self._log.damage() else []
        if self._sessions > 1:
            found.append(f"{self._sessions} sessions of the driver; the longest is shown")
        for channel in NUMERIC:
            lost = self._log.lost(channel) if channel in self._log.channels else 0
            if lost:
                found.append(f"{lost} messages of {channel} are missing")
        return found

    def close(self) -> None:
        pass


def _longest_session(log: Log) -> tuple[int, int]:
    """Its number, and how many there are."""
    sessions, counts = np.unique(log.read("JOINT_STATE")["session"], return_counts=True)
    if not len(sessions):
        raise InputError(f"{log.path} holds no JOINT_STATE: there is no arm to show")
    return int(sessions[np.argmax(counts)]), len(sessions)
