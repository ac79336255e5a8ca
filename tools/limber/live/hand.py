"""The hand of a running arm: `arm.hand`."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from limber.errors import InputError
from limber.live.arm_base import check_fault
from limber.live.stack_link import StackLink
from limber.live.values import number
from limber.messages import message_class

PRESS_M = 0.02  # so far beyond closed a goal may lie (hand_goal_t)
MOVE_S = 20.0
FLAGS = ("grasped", "moving", "warm")
FOUND_S = 1.0
SETTLE_S = 0.15  # a goal that has just been taken moves nothing yet


@dataclass(frozen=True)
class HandState:
    """The hand at one time, as HAND_STATE: m, m/s, N.

    `opening`: 0 closed, 1 open; `force_N`: with which each finger presses, by the motor's torque;
    `grasped`: something is held; `moving`: on its way; `warm`: heat leaves less than the peak
    torque.
    """

    time_s: float
    width_m: float
    max_width_m: float
    speed_m_per_s: float
    opening: float
    force_N: float
    grasped: bool
    moving: bool
    warm: bool
    temperature_degC: float
    goal_width_m: float
    goal_force_N: float


class Hand:
    """Requests to the hand; the arm is to be active. InputError if it has none."""

    def __init__(self, link: StackLink, send: Any) -> None:
        self._link = link
        self._send = send

    def __call__(self, width_m: float, force_N: float = 0.0, speed_m_per_s: float = 0.0) -> Any:
        """Sets a width, with the most force and speed (0: robot.yaml's); does not wait. Returns the
        REQUEST_ANSWER.
        """
        self._newest()
        message = message_class("hand_goal_t")()
        message.width_m = number("width_m", width_m, -PRESS_M, 1.0)
        message.force_N = number("force_N", force_N, 0.0)
        message.speed_m_per_s = number("speed_m_per_s", speed_m_per_s, 0.0)
        return self._send(message)

    def open(self, speed_m_per_s: float = 0.0, timeout_s: float = MOVE_S) -> HandState:
        """Opens, and returns when the fingers stand still."""
        return self._move(float(self._newest()["max_width_m"]), 0.0, speed_m_per_s, timeout_s)

    def close(
        self, force_N: float = 0.0, speed_m_per_s: float = 0.0, timeout_s: float = MOVE_S
    ) -> HandState:
        """Closes, with at most that force, likewise."""
        return self._move(-PRESS_M, force_N, speed_m_per_s, timeout_s)

    def grasp(
        self, force_N: float = 0.0, speed_m_per_s: float = 0.0, timeout_s: float = MOVE_S
    ) -> bool:
        """The same; True if something, of any width, is held then."""
        return self.close(force_N, speed_m_per_s, timeout_s).grasped

    @property
    def state(self) -> HandState:
        """The hand of this moment."""
        return _state(self._newest())

    def _newest(self) -> np.void:
        state = self._link.receiver.newest("HAND_STATE")
        if state is None:
            self._link.check()
            self._link.receiver.wait_for(
                lambda: self._link.receiver.newest("HAND_STATE") is not None, FOUND_S
            )
            state = self._link.receiver.newest("HAND_STATE")
        if state is None:
            raise InputError(f"{self._link.name} has no hand in robot.yaml")
        return state

    def _move(
        self, width_m: float, force_N: float, speed_m_per_s: float, timeout_s: float
    ) -> HandState:
        """Returns when the goal was followed and the fingers have stood still for 0.1 s."""
        stream = self._link.receiver.stream("HAND_STATE")
        try:
            taken_ns = self(width_m, force_N, speed_m_per_s).time_ns
            for arm in self._link.statuses(timeout_s, "the hand"):
                check_fault(arm)
                for state in stream.read():
                    since_s = (int(state["time_ns"]) - taken_ns) * 1e-9
                    if since_s > SETTLE_S and not state["moving"]:
                        return _state(state)
        finally:
            stream.close()
        raise AssertionError("statuses() does not end")


def _state(state: np.void) -> HandState:
    given: dict[str, Any] = {
        name: (bool if name in FLAGS else float)(state[name])
        for name in HandState.__dataclass_fields__
        if name != "time_s"
    }
    return HandState(time_s=float(state["time_ns"]) * 1e-9, **given)


def hand_text(state: np.void) -> str:
    """Of a HAND_STATE, in a line."""
    parts = [f"hand {float(state['width_m']) * 1e3:.1f} mm", f"{float(state['force_N']):.1f} N"]
    parts += [word for word in FLAGS if state[word]]
    if state["temperature_degC"]:  # that the drive reports
        parts.append(f"{float(state['temperature_degC']):.0f} °C")
    return ", ".join(parts)
