"""Modes of a running arm: enabled, held, soft, stopped."""

from collections.abc import Callable
from typing import Any

from limber.live.arm_base import POWER_S, ArmBase, check_fault
from limber.live.arm_errors import (
    FaultError,
    RecoveryError,
    RefusedError,
    StackLostError,
    WaitTimeoutError,
)
from limber.live.way import TAKES, way_from
from limber.messages import message_class

RELEASE = (
    "A drive that was in error is enabled again only after idle, which releases all drives: "
    "support the arm, then recover(release=True), or limber send --release recover."
)
STEADY_S = 2.0  # after the cause has gone the controller waits for steady states of the arm


class Modes(ArmBase):
    """Requests of modes; each returns when the arm is in it."""

    def activate(self, timeout_s: float = POWER_S) -> None:
        """Enables the drives if need be, and starts the control law; returns when it runs.

        Raises FaultError in FAULT and ESTOP: see acknowledge().
        """
        if self.mode != "active":
            self.hold(timeout_s)
        asked_s = float("-inf")
        for state in self._link.statuses(timeout_s, "springs to be wound up"):
            check_fault(state)
            if state.time_s <= asked_s + 0.1:
                continue
            asked_s = state.time_s
            try:
                self._mode("ACTIVE")
                break
            except RefusedError as refused:
                if refused.code != "request.PRELOAD":
                    raise
        self.wait(mode="active", timeout_s=timeout_s)

    def hold(self, timeout_s: float = POWER_S) -> None:
        """Holds the arm where it is, with the drives enabled; a motion is stopped within 0.3 s."""
        asked_s = float("-inf")
        for state in self._link.statuses(timeout_s, "to be held"):
            check_fault(state)
            if state.mode == "hold" and state.drives == "on":
                break
            if state.mode in ("idle", "active") and state.time_s > asked_s + 0.1:
                self._mode("HOLD")
                asked_s = state.time_s
        self._mode("HOLD")

    def idle(self, timeout_s: float = POWER_S) -> None:
        """Disables the drives. An arm without brakes sinks."""
        if self.mode in ("active", "soft_stop"):
            self.hold(timeout_s)
        self._mode("IDLE")
        self.wait(mode="idle", until=lambda state: state.drives != "on", timeout_s=timeout_s)

    def stop(self) -> None:
        """Stops the motion within 0.3 s, then the arm is held. Needs no lease; from any thread.

        No emergency stop: that one cuts motor power.
        """
        for attempt in range(3):
            try:
                self._port.send(_request("STOP"), timeout_s=0.3)
                return
            except StackLostError:
                if attempt == 2:
                    raise

    def acknowledge(self) -> None:
        """Ends FAULT or ESTOP, once the cause is gone; then the arm is in idle."""
        self._mode("ACKNOWLEDGE")
        self.wait(mode="idle", timeout_s=POWER_S)

    def recover(self, timeout_s: float = POWER_S, release: bool | None = None) -> None:
        """Back to a running law, from FAULT and ESTOP too: acknowledge(), hold(), activate(), as
        far as they are needed, each within `timeout_s`. First cure the cause.

        A drive that was in error is enabled again only after idle(), which releases all drives: an
        arm without brakes sinks. `release` permits that; None: on simulated arms only. Raises
        RecoveryError with the step that failed and why.
        """
        may = self.simulated if release is None else release
        steps: dict[str, Callable[[float], None]] = {
            "acknowledge": self._acknowledge_steady,
            "hold": lambda limit_s: self._hold_again(limit_s, may),
            "active": self.activate,
        }
        step = "wait"
        try:
            self.wait(until=lambda state: bool(TAKES[state.mode.upper()]), timeout_s=timeout_s)
            for step in way_from(self.mode.upper(), "active"):
                steps[step](timeout_s)
        except (FaultError, RefusedError, WaitTimeoutError) as error:
            raise RecoveryError(step, self.mode, error) from error

    def _hold_again(self, timeout_s: float, release: bool) -> None:
        try:
            self.hold(timeout_s)
        except FaultError as fault:
            if "DRIVE_NOT_ON" not in str(fault):
                raise
            if not release:
                raise FaultError(self.mode, [*fault.faults, RELEASE]) from fault
            self._acknowledge_steady(timeout_s)
            self.idle(timeout_s)
            self.wait(until=lambda state: state.drives == "off", timeout_s=timeout_s)
            self.hold(timeout_s)

    def _acknowledge_steady(self, timeout_s: float) -> None:
        asked_s, first_s = float("-inf"), None
        for state in self._link.statuses(timeout_s, "steady states of the arm"):
            if state.time_s <= asked_s + 0.1:
                continue
            asked_s = state.time_s
            first_s = asked_s if first_s is None else first_s
            try:
                self.acknowledge()
                return
            except RefusedError as refused:
                if refused.code != "request.CAUSE_REMAINS" or asked_s - first_s > STEADY_S:
                    raise

    def release(self) -> None:
        """Gives the lease back; the arm stays as it is."""
        self._mode("RELEASE")
        self._requested = False

    def _mode(self, word: str) -> None:
        self._send(_request(word))


def _request(word: str) -> Any:
    message = message_class("mode_request_t")()
    message.request = getattr(message, f"REQUEST_{word}")
    return message
