"""Reach: bring the tip to a point and stay there."""

from typing import Any

import numpy as np

from limber.arrays import Floats
from limber.gym.actions import Where
from limber.gym.arm_env import ArmEnv
from limber.live.values import number

REST_M_PER_S = 0.05


class Reach(ArmEnv):
    """The target is where the tip would be with the joints up to `reach_rad` (of prismatic ones, m)
    from the start, so that the arm can be there.

    Reward: minus the distance, m, and 1 at the end: within `tolerance_m`, slower than 0.05 m/s.
    `environment_state`: the target, base frame, m.
    """

    task_size = 3

    def __init__(
        self, *args: Any, reach_rad: float = 0.25, tolerance_m: float = 0.01, **more: Any
    ) -> None:
        self._reach_rad = number("reach_rad", reach_rad, 0.0, 3.0)
        self._tolerance_m = number("tolerance_m", tolerance_m, 1e-4, 1.0)
        self._target: Floats = np.zeros(3)
        super().__init__(*args, **more)

    def start_task(self, at: Where) -> None:
        q = at.q + self.np_random.uniform(-self._reach_rad, self._reach_rad, len(at.q))
        low, high = self.actions.ends
        self._target = self.robot.chain.forward(np.clip(q, low, high))[:3, 3]

    def task_state(self) -> Floats:
        return self._target

    def judge(self, at: Where) -> tuple[float, bool]:
        distance_m = float(np.linalg.norm(at.p - self._target))
        speed = float(np.linalg.norm(self._status["V_BT"][:3]))
        success = distance_m < self._tolerance_m and speed < REST_M_PER_S
        return -distance_m + success, success
