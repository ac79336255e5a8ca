"""Arm time as the wall clock, for what goes to other programs live (ROS 2, Foxglove)."""

from limber.live.stack_link import LOCKSTEP_SESSION

DRIFT = 1e-3  # of the clocks against each other, more than NTP's slewing
STEP_NS = 1_000_000_000  # the wall clock was set


class Stamps:
    """The offset is the least that was seen, since a message may arrive late and never early. In
    lock step, where arm time is not the clock's, a stamp is the time of arrival.
    """

    def __init__(self) -> None:
        self._session = self._offset_ns = self._noted_ns = 0

    def note(self, session: int, arm_ns: int, now_ns: int) -> None:
        """A message of the driver with this arm time has just arrived."""
        seen_ns = now_ns - arm_ns
        drifted_ns = self._offset_ns + int(DRIFT * max(0, now_ns - self._noted_ns))
        if session != self._session or seen_ns > drifted_ns + STEP_NS:
            drifted_ns = seen_ns
        self._session, self._noted_ns = session, now_ns
        self._offset_ns = min(seen_ns, drifted_ns)

    def of(self, arm_ns: int, now_ns: int) -> int:
        """ns since 1970, never after `now_ns`."""
        if self._session == LOCKSTEP_SESSION:
            return now_ns
        return min(now_ns, arm_ns + self._offset_ns)
