"""Has a motion ended, and where."""

from collections import deque

import numpy as np

from limber.live.arm_state import State

REST_S = 0.25  # at rest is who has not moved this long
REST_RAD = 2e-3  # within that time, of any joint (m of prismatic ones)


class RestWatch:
    """Tells whether goal and arm stand still; takes the states in order."""

    def __init__(self) -> None:
        self._window: deque[tuple[float, np.ndarray, np.ndarray]] = deque()

    def at_rest(self, state: State) -> bool:
        """Of the newest state, with those before it."""
        goal = np.concatenate([state.goal.p, state.goal.quat])
        now_s = state.time_s
        self._window.append((now_s, goal, state.q))
        while self._window[0][0] < now_s - REST_S - 0.1:
            self._window.popleft()
        if now_s - self._window[0][0] < REST_S:
            return False
        still = all(np.array_equal(goal, before) for _, before, _ in self._window)
        return still and all(np.abs(state.q - q).max() <= REST_RAD for _, _, q in self._window)


class Target:
    """Where a motion shall end, and what of it was requested."""

    def __init__(
        self,
        joints_rad: np.ndarray | None = None,
        turns: bool = False,
        tolerance_m: float = 0.0,
        tolerance_rad: float = 0.0,
    ) -> None:
        self._joints_rad = joints_rad
        self._turns = turns
        self._tolerance_m = tolerance_m
        self._tolerance_rad = tolerance_rad

    def missing(self, state: State) -> dict[str, float]:
        """Distance of a state to the goal, in the words of NotReachedError."""
        if self._joints_rad is not None:
            return {"distance_rad": float(np.abs(state.q - self._joints_rad).max())}
        distance_m, angle_rad = state.pose.distance(state.goal)
        return {"distance_m": distance_m} | ({"angle_rad": angle_rad} if self._turns else {})

    def reached(self, state: State) -> bool:
        missing = self.missing(state)
        return missing.pop("distance_m", 0.0) <= self._tolerance_m and all(
            value <= self._tolerance_rad for value in missing.values()
        )
