"""Peg: put the round-nosed peg in the hand into a hole with a chamfer."""

from typing import Any

import numpy as np

from limber.arrays import Floats
from limber.gym.actions import Where
from limber.gym.arm_env import ArmEnv
from limber.model.rotations import matrix_of

AHEAD_M = 0.03  # from the nose to the plate at the start
PEG_M = 0.05  # from its nose to where it is held
CHAMFER_M, DEPTH_M = 0.003, 0.03


class Peg(ArmEnv):
    """The hole's axis is the tip's z axis at the start; its mouth lies 30 mm ahead and up to
    `offset_m` aside. Peg: two balls of `peg_radius_m`, 50 mm apart, so that it may tilt and jam;
    hole: `clearance_m` wider in radius, chamfer 3 mm, 30 mm deep; Coulomb's `friction`.

    Reward: minus the distance of the nose from the floor, m, and 1 at the end: 25 mm deep.
    `environment_state`: mouth (m), axis into the hole, base frame.
    """

    task_size = 6

    def __init__(
        self,
        *args: Any,
        offset_m: float = 0.01,
        peg_radius_m: float = 0.008,
        clearance_m: float = 0.0005,
        friction: float = 0.2,
        **more: Any,
    ) -> None:
        self._offset_m, self._radius_m = offset_m, peg_radius_m
        self._clearance_m, self._friction = clearance_m, friction
        self._mouth: Floats = np.zeros(3)
        self._axis: Floats = np.zeros(3)
        super().__init__(*args, **more)

    def start_task(self, at: Where) -> None:
        R = matrix_of(at.quat)
        aside = self.np_random.uniform(-self._offset_m, self._offset_m, 2)
        self._axis = R[:, 2]
        self._mouth = at.p + R @ np.array([*aside, AHEAD_M + self._radius_m])
        self.place_plate()

    def place_plate(self) -> None:
        self.place(
            "HOLE",
            point=self._mouth,
            normal=-self._axis,
            tip_radius_m=self._radius_m,
            peg=[0.0, 0.0, -PEG_M],
            friction=self._friction,
            radius_m=self._radius_m + self._clearance_m,
            chamfer_m=CHAMFER_M,
            depth_m=DEPTH_M,
        )

    def task_state(self) -> Floats:
        return np.concatenate([self._mouth, self._axis])

    def judge(self, at: Where) -> tuple[float, bool]:
        from_mouth = at.p - self._mouth
        along = float(self._axis @ from_mouth)
        aside_m = float(np.linalg.norm(from_mouth - along * self._axis))
        depth_m = along + self._radius_m  # of the nose
        success = depth_m > DEPTH_M - 0.005 and aside_m < self._radius_m
        return -float(np.hypot(aside_m, DEPTH_M - depth_m)) + success, success
