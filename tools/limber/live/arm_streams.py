"""Targets with times for a running arm: single ones, chunks, and torques on top."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from limber.errors import InputError
from limber.live import stream_messages
from limber.live.arm_base import ArmBase
from limber.live.values import number, numbers

TRANSPORT_S = 0.01
VALID_S = 5.0
ROWS = ("joints_rad", "position_m", "quaternion_wxyz", "twist")  # of a target: one row a knot


class Stream:
    """Targets 10 to 60 times a second, each stamped with the arm time it is sent at.

    `delay_s`: how much later a target acts than it is stamped; the goal runs so far behind.
    """

    def __init__(self, arm: "Streams", delay_s: float, valid_for_s: float) -> None:
        self._arm = arm
        self.delay_s = number("delay_s", delay_s, 0.0, 2.0)
        self.valid_for_s = number("valid_for_s", valid_for_s, 0.0, 600.0)

    def send(self, *, time_s: float | None = None, **target: Any) -> None:
        """One target: joints_rad, or position_m (with quaternion_wxyz, else the goal's), or twist
        (m/s, rad/s, base axes). With it hand_width_m, hand_force_N, stiffness_scale (0.05..1),
        force_N, torque_Nm.

        `time_s`: arm time that it is for, now by default. Never waits. RefusedError if an earlier
        one was refused.
        """
        rows = {
            key: [value] if key in ROWS else value
            for key, value in target.items()
            if value is not None
        }
        self._arm.chunk(
            np.zeros(1), start_s=time_s, delay_s=self.delay_s, valid_for_s=self.valid_for_s, **rows
        )


class Streams(ArmBase):
    """Targets that are sent, not asked for: no answer, unless one is refused."""

    def stream(
        self,
        rate_hz: float = 30.0,
        *,
        jitter_s: float = 0.0,
        delay_s: float | None = None,
        valid_for_s: float = VALID_S,
    ) -> Stream:
        """A stream of targets such as a policy or a teleoperator makes; the arm is to be active.

        The goal passes through the targets in time, smooth in acceleration, `delay_s` late: by
        default a period, `jitter_s` of the way here and 10 ms. With less it extrapolates. When no
        target comes it comes to rest and stays ready; after `valid_for_s` the arm is held.
        """
        period_s = 1.0 / number("rate_hz", rate_hz, 1.0, 1000.0)
        late_s = period_s + number("jitter_s", jitter_s, 0.0, 1.0) + TRANSPORT_S
        return Stream(self, late_s if delay_s is None else delay_s, valid_for_s)

    def chunk(
        self,
        dt_s: ArrayLike,
        *,
        start_s: float | None = None,
        valid_for_s: float = VALID_S,
        **targets: Any,
    ) -> None:
        """Many targets at once, a row each, such as a policy's action chunk; does not wait.

        `dt_s`: times after `start_s` (arm time, now by default), or one step for all. They replace
        every target that waits for then or later. Keys as in Stream.send(), and delay_s.
        """
        rows = next((len(targets[key]) for key in ROWS if targets.get(key) is not None), 0)
        steps = np.asarray(dt_s, float)
        times = np.arange(rows) * number("dt_s", float(steps)) if steps.ndim == 0 else steps
        times = numbers("dt_s", times, (rows,))
        if rows == 0 or (np.diff(times) < 0.001).any() or times[0] < 0.0 or times[-1] > 10.0:
            raise InputError("dt_s: expected times that rise by 1 ms or more, within 0..10 s")
        position_m, turned = targets.get("position_m"), targets.get("quaternion_wxyz")
        if position_m is not None and turned is None:
            targets["quaternion_wxyz"] = np.tile(self.goal.quat, (rows, 1))
        t0_ns = round(1e9 * (self.time_s if start_s is None else number("start_s", start_s, 0.0)))
        targets["valid_for_s"] = valid_for_s
        for message in stream_messages.targets(len(self.joint_names), times, targets):
            message.t0_ns = t0_ns
            self._stream(message)

    def overlay(self, torque_Nm: ArrayLike, for_s: float = 0.01) -> None:
        """Torque on top of the law's, one a joint, until the next one, at most `for_s` (0.05 s);
        then it fades. At most a third of a joint's limit. Does not wait.
        """
        self._stream(stream_messages.overlay(len(self.joint_names), torque_Nm, for_s))

    def _stream(self, message: Any) -> None:
        self._requested = True
        self._port.stream(message)
