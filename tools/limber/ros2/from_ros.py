"""ROS's messages as requests: their form is checked here, the rest as of any script (live/)."""

import threading
import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from math import prod
from typing import Any

from limber.errors import InputError, LimberError
from limber.live.arm import Arm
from limber.live.values import numbers, unit
from limber.ros2 import ros_types as ros

RAMP_S = 0.5
AGAIN_S = 1.0  # the same words are printed at most this often
STIFFNESS = ("K_x_translation_N_per_m", "K_x_rotation_Nm_per_rad")


def goal_of(message: ros.PoseStamped, base: str) -> dict[str, Any]:
    """Keys of a goal. InputError for another frame, a number that is not finite, no unit
    quaternion.
    """
    frame = message.header.frame_id
    if frame != base:
        raise InputError(f"frame_id is {frame!r}; expected {base!r}, the arm's base")
    at, turned = message.pose.position, message.pose.orientation
    wxyz = [turned.w, turned.x, turned.y, turned.z]
    return {
        "position_m": numbers("position", [at.x, at.y, at.z], (3,)),
        "quaternion_wxyz": unit("orientation", wxyz, 4),
    }


def stiffness_of(message: ros.Float64MultiArray) -> dict[str, Any]:
    """Keys of the gains: three numbers, N/m, or six, then N m/rad. InputError for other sizes."""
    size, layout = len(message.data), message.layout
    if size not in (3, 6):
        raise InputError(f"expected 3 numbers, N/m, or 6, the others N m/rad; got {size}")
    if layout.data_offset or (layout.dim and prod(dim.size for dim in layout.dim) != size):
        raise InputError(f"the layout is not that of {size} numbers without an offset")
    given = numbers("data", list(message.data), (size,))
    return dict(zip(STIFFNESS, given.reshape(-1, 3), strict=False))


@dataclass
class Outcomes:
    """`refusal`: of the last command, empty if it was accepted; `last_refusal` stays."""

    accepted: int = 0
    refused: int = 0
    refusal: str = ""
    last_refusal: str = ""


class Requests:
    """Commands to the arm, one after the other; `tell` prints a line. For one thread, `outcomes`
    apart.
    """

    def __init__(self, arm: Arm, base: str, tell: Callable[[str], None]) -> None:
        self._arm, self._base, self._tell = arm, base, tell
        self._told, self._told_s = "", float("-inf")
        self._lock = threading.Lock()
        self._outcomes = Outcomes()

    @property
    def outcomes(self) -> Outcomes:
        with self._lock:
            return Outcomes(**vars(self._outcomes))

    def goal(self, message: ros.PoseStamped) -> None:
        self._ask(
            "goal_pose",
            lambda: self._arm.set_goal(**goal_of(message, self._base), duration_s=0.0),
        )

    def stiffness(self, message: ros.Float64MultiArray) -> None:
        self._ask("stiffness", lambda: self._arm.gains(None, RAMP_S, **stiffness_of(message)))

    def unreadable(self, name: str, error: Exception) -> None:
        self._refuse(f"{name}: cannot be read: {error}")

    def _ask(self, name: str, request: Callable[[], Any]) -> None:
        try:
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                request()
        except LimberError as error:
            self._refuse(f"{name}: {error}")
            return
        for warning in caught:
            self._say(f"{name}: {warning.message}")
        with self._lock:
            self._outcomes.accepted += 1
            self._outcomes.refusal = ""

    def _refuse(self, words: str) -> None:
        with self._lock:
            self._outcomes.refused += 1
            self._outcomes.refusal = self._outcomes.last_refusal = words
        self._say(words)

    def _say(self, words: str) -> None:
        now_s = time.monotonic()
        if words != self._told or now_s - self._told_s >= AGAIN_S:
            self._told, self._told_s = words, now_s
            self._tell(words)
