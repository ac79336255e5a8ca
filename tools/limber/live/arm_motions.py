"""Goals of a running arm: motions that end at them, and streams of them."""

from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from limber.live import request_messages
from limber.live.arm_base import MOTION_S, ArmBase, check_fault
from limber.live.arm_errors import NotReachedError, WaitTimeoutError
from limber.live.arm_state import Pose, State
from limber.live.arrival import RestWatch, Target
from limber.live.values import number


class Motions(ArmBase):
    """Requests of goals; the arm is to be active."""

    def go_to(
        self,
        pose: Pose | None = None,
        *,
        position_m: ArrayLike | None = None,
        quaternion_wxyz: ArrayLike | None = None,
        joints_rad: ArrayLike | None = None,
        posture_rad: ArrayLike | None = None,
        duration_s: float = 0.0,
        tolerance_m: float = 0.02,
        tolerance_rad: float = 0.1,
        timeout_s: float = MOTION_S,
    ) -> State:
        """Moves the tip to a pose, or the joints, and returns when the arm is there and at rest.

        A pose, or its position (m, base frame) with or without its orientation (default: that of
        the goal). Or joints, rad or m. `posture_rad`: joints of a redundant arm at that pose. The
        motion takes `duration_s`, or longer where it would be too fast; 0: a moderate speed. A soft
        arm rests beside its goal, by friction and load: more than `tolerance_m`, `tolerance_rad`
        away it raises NotReachedError with the distance missing.
        """
        if pose is not None:
            position_m, quaternion_wxyz = pose.p, pose.quat
        turns = quaternion_wxyz is not None
        wanted = None if joints_rad is None else np.asarray(joints_rad, float)
        target = Target(wanted, turns, tolerance_m, tolerance_rad)
        answer = self.set_goal(
            position_m=position_m,
            quaternion_wxyz=self._orientation(position_m, quaternion_wxyz),
            joints_rad=joints_rad,
            posture_rad=posture_rad,
            duration_s=duration_s,
        )
        return self._arrive(answer, target, timeout_s)

    def move(
        self,
        offset_m: ArrayLike = (0.0, 0.0, 0.0),
        offset_rad: ArrayLike = (0.0, 0.0, 0.0),
        *,
        duration_s: float = 0.0,
        tolerance_m: float = 0.02,
        tolerance_rad: float = 0.1,
        timeout_s: float = MOTION_S,
    ) -> State:
        """Moves the goal by an offset, m, and a rotation vector, rad, in base axes; as go_to()."""
        target = Target(None, bool(np.any(offset_rad)), tolerance_m, tolerance_rad)
        answer = self.set_goal(offset_m=offset_m, offset_rad=offset_rad, duration_s=duration_s)
        return self._arrive(answer, target, timeout_s)

    def set_goal(self, **keys: Any) -> Any:
        """Sets any goal of a scenario and returns its REQUEST_ANSWER, without waiting for a motion.

        offset_m, offset_rad; position_m, quaternion_wxyz; joints_rad; circle_centre_m, circle_axis;
        force_N, torque_Nm; with posture_rad, duration_s and valid_for_s (scenarios/README.md).
        """
        return self._send(request_messages.goal(len(self.joint_names), **keys))

    def track(
        self,
        *,
        position_m: ArrayLike | None = None,
        quaternion_wxyz: ArrayLike | None = None,
        joints_rad: ArrayLike | None = None,
        horizon_s: float = 0.1,
        **keys: Any,
    ) -> None:
        """A goal for the next `horizon_s`, to rest; does not wait for the motion. stream() follows
        sooner, and more smoothly.

        It goes on from the motion under way, and follows 0.6 horizons and half a period behind.
        `horizon_s`: three periods or more, at least 0.1 s. Further keys as in set_goal().
        """
        self.set_goal(
            position_m=position_m,
            quaternion_wxyz=self._orientation(position_m, quaternion_wxyz),
            joints_rad=joints_rad,
            duration_s=number("horizon_s", horizon_s, 0.1, 10.0),
            **keys,
        )

    def _orientation(self, position_m: Any, quaternion_wxyz: Any) -> Any:
        """That of the goal, where a position comes without one."""
        if position_m is None or quaternion_wxyz is not None:
            return quaternion_wxyz
        return self.goal.quat

    def _arrive(self, answer: Any, target: Target, timeout_s: float) -> State:
        rest = RestWatch()
        with suppress(WaitTimeoutError):
            for state in self._link.statuses(timeout_s, "the goal"):
                check_fault(state)
                if state.status["time_ns"] <= answer.time_ns:
                    continue
                if state.mode != "active":
                    raise NotReachedError(f"stopped, mode {state.mode}", **target.missing(state))
                if rest.at_rest(state):
                    if target.reached(state):
                        return state
                    raise NotReachedError(_why(state), **target.missing(state))
        raise NotReachedError(f"still moving after {timeout_s:g} s", **target.missing(self.state))


def _why(state: State) -> str:
    acting = f"; limits that act: {', '.join(state.limits)}" if state.limits else ""
    return f"the arm rests there, held by friction, load or contact against its stiffness{acting}"
