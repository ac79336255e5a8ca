"""Push: slide a block over a table to a place."""

from typing import Any

import numpy as np

from limber.arrays import Floats
from limber.gym.actions import Where
from limber.gym.arm_env import ArmEnv

SIZE_M = (0.06, 0.06, 0.08)
TIP_RADIUS_M = 0.01
BEFORE_M = 0.05  # of the tip, at the start: middle of the block


class Push(ArmEnv):
    """A block of 60 x 60 x 80 mm stands before the tip, along the base's x axis, on a table 40 mm
    below it; it is to be moved by up to `distance_m` forwards and half of that aside. The tip is a
    ball of 10 mm. The block slides and turns with Coulomb's friction, and does not tip; the tip
    does not touch the table. `mass_kg`, `table_friction`: ranges to draw from.

    Reward: minus the block's distance from its place, m, and 1 at the end: within `tolerance_m`.
    `environment_state`: block (x, y, m; yaw, rad), its place (x, y), base frame.
    """

    task_size = 5

    def __init__(
        self,
        *args: Any,
        distance_m: float = 0.1,
        tolerance_m: float = 0.015,
        mass_kg: tuple[float, float] = (0.3, 0.7),
        friction: float = 0.3,
        table_friction: tuple[float, float] = (0.2, 0.4),
        **more: Any,
    ) -> None:
        self._distance_m, self._tolerance_m, self._friction = distance_m, tolerance_m, friction
        self._mass_kg, self._table_friction = mass_kg, table_friction
        self._place: Floats = np.zeros(2)
        super().__init__(*args, **more)

    def start_task(self, at: Where) -> None:
        draw = self.np_random.uniform
        base = at.p + np.array([BEFORE_M, draw(-0.01, 0.01), -0.5 * SIZE_M[2]])
        far = draw(0.5, 1.0) * self._distance_m
        self._place = base[:2] + np.array([far, draw(-0.5, 0.5) * far])
        self.place(
            "BLOCK",
            point=base,
            normal=[0.0, 0.0, 1.0],
            tip_radius_m=TIP_RADIUS_M,
            friction=self._friction,
            yaw=draw(-0.2, 0.2),
            size=SIZE_M,
            mass_kg=draw(*self._mass_kg),
            table_friction=draw(*self._table_friction),
        )

    def task_state(self) -> Floats:
        block = self.open_lab().message("BLOCK_TRUTH")
        return np.array([*block["p_BO"][:2], block["yaw"], *self._place])

    def judge(self, at: Where) -> tuple[float, bool]:
        distance_m = float(np.linalg.norm(self.task_state()[:2] - self._place))
        success = distance_m < self._tolerance_m
        return -distance_m + success, success
