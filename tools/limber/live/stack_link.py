"""The connection of a script to a running driver and controller."""

import time
from collections.abc import Iterator
from contextlib import suppress

import numpy as np

from limber import messages
from limber.live.arm_errors import NoStackError, StackLostError, WaitTimeoutError
from limber.live.arm_state import State
from limber.live.episodes import KEPT
from limber.live.receiver import Receiver

CHANNELS = ("JOINT_STATE", "CONTROLLER_STATUS", "ROBOT_INFO", "REQUEST_ANSWER", "HAND_STATE", KEPT)
SENDERS = {
    "JOINT_STATE": "limber-driver",
    "CONTROLLER_STATUS": "limber-controller",
    "ROBOT_INFO": "limber-controller",
}
FOUND_S = 1.0  # within this time something of the stack is heard, or there is none
COMPLETE_S = 30.0  # and all of it: in lock step on a busy machine its time passes slowly
SILENT_S = 1.0  # after this time it is lost; a busy machine stands still for tenths of a second
WAITING_S = 20.0  # the same in lock step, where simulated time waits for the machine
LOCKSTEP_SESSION = 1  # of every run in lock step (common/run_id.h)
PATIENCE = 20  # no wait for so much arm time takes longer than so many times it by the clock
INTERVAL_S = 0.002  # age of the newest values, at most, beside the channel's own period


class StackLink:
    """Finds the stack and its robot. `robot`: refuse any other.

    `name`, `folder`, `joints`, `simulated`: the robot's name and folder, its joints' names, and
    whether all of its buses are simulated. Raises NoStackError.
    """

    def __init__(self, robot: str | None = None, url: str | None = None) -> None:
        self._url = url or messages.user_plane_url()
        self.receiver = Receiver(*CHANNELS, interval_s=INTERVAL_S, url=self._url)
        self._closed = False
        self._infos = 0
        try:
            self._find(robot)
        except BaseException:
            self.receiver.close()
            raise

    def _find(self, robot: str | None) -> None:
        heard = [self.receiver.channels[name] for name in SENDERS]
        self.receiver.wait_for(lambda: any(state.count for state in heard), FOUND_S)
        patience_s = COMPLETE_S if any(state.count for state in heard) else 0.0
        if not self.receiver.wait_for(lambda: all(state.count for state in heard), patience_s):
            silent = next(who for name, who in SENDERS.items() if not self._count(name))
            raise NoStackError(
                f"{silent} is not heard at {self._url.split('?')[0]}: start a "
                "stack, such as `limber run scenarios/ready.yaml`, on this machine and in this "
                "network namespace"
            )
        data = self.receiver.channels["ROBOT_INFO"].data
        info = messages.decode("robot_info_t", data)
        if robot is not None and robot != info.robot:
            raise NoStackError(f"the running stack is that of {info.robot}, not of {robot}")
        self.name: str = info.robot
        self._runs = self.name
        self.folder: str = info.folder
        self.joints: tuple[str, ...] = tuple(info.joints)
        self.simulated = bool(info.simulated)

    def _count(self, channel: str) -> int:
        return self.receiver.channels[channel].count

    def records(self) -> tuple[np.void, np.void]:
        """The newest JOINT_STATE and CONTROLLER_STATUS; StackLostError if one has become old."""
        self.check()
        state = self.receiver.newest("JOINT_STATE")
        status = self.receiver.newest("CONTROLLER_STATUS")
        assert state is not None and status is not None
        return state, status

    def check(self) -> None:
        """Raises StackLostError if driver or controller are silent, or this end is closed."""
        if self._closed:
            raise StackLostError("this Arm is closed: make another")
        longest_s = WAITING_S if self.in_lockstep() else SILENT_S
        for channel in ("JOINT_STATE", "CONTROLLER_STATUS"):
            age_s = self.receiver.channels[channel].age_s()
            if age_s > longest_s:
                raise StackLostError(
                    f"{SENDERS[channel]} has been silent for {age_s:.1f} s: see whether it still "
                    "runs, and its log"
                )
        self._check_robot()

    def _check_robot(self) -> None:
        """Another arm's stack may have taken the place of this one's."""
        heard = self.receiver.channels["ROBOT_INFO"]
        if heard.count != self._infos:
            self._infos = heard.count
            with suppress(ValueError):
                self._runs = messages.decode("robot_info_t", heard.data).robot
        if self._runs != self.name:
            raise StackLostError(f"the running stack is now that of {self._runs}, not {self.name}")

    def in_lockstep(self) -> bool:
        """Arm time is simulated: it waits for the machine, or outruns the clock."""
        state = self.receiver.newest("JOINT_STATE")
        return state is not None and int(state["session"]) == LOCKSTEP_SESSION

    def pass_time(self, until_s: float) -> None:
        """Returns when arm time is `until_s`, or that of a new session."""
        start_s = self._time_s()
        while start_s <= self._time_s() < until_s:
            self.check()
            self.receiver.wait_for(lambda: self._time_s() >= until_s, 0.1)

    def _time_s(self) -> float:
        """Arm time of the newest state."""
        state = self.receiver.newest("JOINT_STATE")
        return 0.0 if state is None else 1e-9 * float(state["time_ns"])

    def state(self) -> State:
        return State(*self.records(), self.joints)

    def statuses(self, timeout_s: float, what: str) -> Iterator[State]:
        """A state for every CONTROLLER_STATUS from now on, none left out.

        Raises StackLostError, or WaitTimeoutError with `what` after `timeout_s` of arm time.
        """
        stream = self.receiver.stream("CONTROLLER_STATUS")
        wall_end_s = time.monotonic() + PATIENCE * timeout_s
        end_s = self._time_s() + timeout_s
        try:
            while True:
                stream.wait(min(0.1, timeout_s))
                self.check()
                for status in stream.read():
                    joint_state = self.receiver.newest("JOINT_STATE")
                    assert joint_state is not None
                    yield State(joint_state, status, self.joints)
                if self._time_s() > end_s or time.monotonic() > wall_end_s:
                    raise WaitTimeoutError(f"{what}: not within {timeout_s:g} s")
        finally:
            stream.close()

    def lost(self) -> dict[str, int]:
        """Messages that were sent and did not arrive, by channel."""
        return {name: state.lost for name, state in self.receiver.channels.items()}

    def close(self) -> None:
        self._closed = True
        self.receiver.close()
