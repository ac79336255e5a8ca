"""What all of a running arm's requests and quantities stand on."""

import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from limber.live.arm_errors import FaultError, RefusedError
from limber.live.arm_state import Quantities, State
from limber.live.arrival import RestWatch
from limber.live.recording import Recording
from limber.live.requests import RequestPort
from limber.live.stack_link import StackLink
from limber.live.values import number

POWER_S = 15.0  # drives need seconds to be enabled
MOTION_S = 60.0


class ArmBase(Quantities):
    """The arm as it is: found, read, waited for, recorded."""

    def __init__(self, robot: str | None, client: int | None, url: str | None) -> None:
        self._link = StackLink(robot, url)
        self._port = RequestPort(self._link, client)
        self._requested = False  # this script may hold the lease
        self._followers: list[Callable[[], None]] = []

    @property
    def name(self) -> str:
        """The robot's name in robot.yaml."""
        return self._link.name

    @property
    def folder(self) -> str:
        """Folder of robot.yaml, on the controller's machine."""
        return self._link.folder

    @property
    def joint_names(self) -> tuple[str, ...]:
        """In the order of all joint quantities."""
        return self._link.joints

    @property
    def simulated(self) -> bool:
        """True if all of its buses are simulated; False: motors move."""
        return self._link.simulated

    @property
    def state(self) -> State:
        """All quantities of this moment, to keep."""
        return self._link.state()

    @property
    def lost(self) -> dict[str, int]:
        """Messages that were sent and did not arrive, by channel."""
        return self._link.lost()

    def states(self, hz: float = 50.0) -> Iterator[State]:
        """The newest state, `hz` times a second, without end; a slow loop misses states. In lock
        step it is a second of arm time.
        """
        period_s = 1.0 / number("hz", hz, 1e-3, 1000.0)
        due_s = time.monotonic()
        while True:
            state = self.state
            yield state
            if self._link.in_lockstep():
                self._link.pass_time(state.time_s + period_s)
                continue
            due_s = max(due_s + period_s, time.monotonic())
            time.sleep(max(0.0, due_s - time.monotonic()))

    def on_state(
        self, callback: Callable[[np.ndarray], None], channel: str = "JOINT_STATE"
    ) -> Callable[[], None]:
        """Calls `callback` with every message of JOINT_STATE or CONTROLLER_STATUS from now on.

        It gets records in order, all since its last call, in a thread of its own; however long it
        takes, none is left out. Fields are those of the message; joint quantities have 16 entries,
        of which the first `len(arm.joint_names)` count. Returns a function that ends it.
        """
        stream = self._link.receiver.stream(channel)
        ended = threading.Event()

        def follow() -> None:
            while not ended.is_set() or stream.waiting():
                stream.wait(0.1)
                if stream.waiting():
                    callback(stream.read())

        def end() -> None:
            stream.close()
            ended.set()
            if thread is not threading.current_thread():
                thread.join()

        thread = threading.Thread(target=follow, name="limber on_state", daemon=True)
        thread.start()
        self._followers.append(end)
        return end

    def wait(
        self,
        *,
        mode: str | None = None,
        contact_N: float | None = None,
        at_rest: bool = False,
        for_s: float = 0.0,
        until: Callable[[State], bool] | None = None,
        timeout_s: float = MOTION_S,
    ) -> State:
        """Until all conditions hold at once; returns the state then.

        `mode`: such as "hold"; `contact_N`: a contact force of at least so much, N; `at_rest`: goal
        and arm stand still; `for_s`: so much arm time has passed; `until`: any function of a state.
        Every CONTROLLER_STATUS is tested. Raises WaitTimeoutError, or FaultError if the arm
        meanwhile faults.
        """
        rest = RestWatch()
        end_s = self.time_s + number("for_s", for_s, 0.0)
        for state in self._link.statuses(for_s + timeout_s, "what was waited for"):
            rests = rest.at_rest(state) if at_rest else True
            force_N = 0.0 if contact_N is None else np.linalg.norm(state.wrench[:3])
            if (
                rests
                and (mode is None or state.mode == mode)
                and (contact_N is None or force_N >= contact_N)
                and state.time_s >= end_s
                and (until is None or until(state))
            ):
                return state
            if mode != state.mode:
                check_fault(state)
        raise AssertionError("statuses() does not end")

    def record(self, path: str | Path) -> Recording:
        """Context manager: an LCM log of every message while the block runs (limber.log.reader).

        Compressed if the name ends in .zst; an existing log is not overwritten.
        Lost messages are counted in its `lost`, with a warning.
        """
        return Recording(Path(path))

    def _records(self) -> tuple[np.void, np.void]:
        return self._link.records()

    def _joint_names(self) -> tuple[str, ...]:
        return self._link.joints

    def _send(self, message: Any) -> Any:
        try:
            answer = self._port.send(message)
        except RefusedError as refused:
            if refused.code == "request.MODE":  # a fault has a cause, and a cure
                check_fault(next(self._link.statuses(1.0, "a status")))
            raise
        self._requested = True
        return answer


def check_fault(state: State) -> None:
    if state.mode in ("fault", "estop"):
        raise FaultError(state.mode, state.faults)
