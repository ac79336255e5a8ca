"""An arm that is led by hand."""

from functools import cached_property
from typing import Any

import numpy as np
from lerobot.teleoperators.teleoperator import Teleoperator

from limber import Arm

from .config import LimberLeaderConfig
from .keys import Keys


class LimberLeader(Teleoperator):
    """Its joints are the action. It carries its weight; LeRobot reflects no force to it."""

    config_class = LimberLeaderConfig
    name = "limber_leader"

    _arm: Arm | None = None

    def __init__(self, config: LimberLeaderConfig) -> None:
        super().__init__(config)
        self.config = config

    @cached_property
    def _keys(self) -> Keys:
        return Keys.of(self.config.arm, self.config.units)

    @property
    def action_features(self) -> dict[str, Any]:
        return dict.fromkeys(self._keys.positions, float)

    @property
    def feedback_features(self) -> dict[str, Any]:
        return {}

    @property
    def is_connected(self) -> bool:
        return self._arm is not None

    def connect(self, calibrate: bool = True) -> None:
        """An arm that another script leads already is only read."""
        arm = Arm(self.config.arm if "/" not in self.config.arm else None, url=self.config.url)
        self._arm = arm
        if arm.mode == "active" and arm.law == "gravity_compensation":
            return
        arm.gains(law="gravity_compensation")
        arm.activate()
        if self._keys.hand_width_m is not None:
            arm.hand(width_m=self._keys.hand_width_m, force_N=self.config.gripper_force_N)

    @property
    def is_calibrated(self) -> bool:
        return True

    def calibrate(self) -> None:
        """Nothing to do: robot.yaml holds signs and offsets."""

    def configure(self) -> None:
        """Nothing to do."""

    def get_action(self) -> dict[str, Any]:
        if self._arm is None:
            raise ConnectionError("limber_leader is not connected: call connect() first")
        hand = () if self._keys.hand_width_m is None else (self._width(self._arm),)
        values = np.array([*(self._arm.q / self._keys.scale), *hand])
        return {key: float(x) for key, x in zip(self._keys.positions, values, strict=True)}

    def send_feedback(self, feedback: dict[str, Any]) -> None:
        """LeRobot calls it for one robot alone, which is not this."""

    def disconnect(self) -> None:
        if self._arm is not None:
            self._arm.close()
        self._arm = None

    def _width(self, arm: Arm) -> float:
        return self._keys.gripper(arm.hand.state.width_m)
