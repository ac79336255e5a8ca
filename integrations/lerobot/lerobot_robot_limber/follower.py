"""The arm that acts."""

from concurrent.futures import Future, ThreadPoolExecutor
from functools import cached_property
from typing import Any

import numpy as np
from lerobot.robots.robot import Robot

from limber import Arm
from limber.live.arm_base import check_fault
from limber.live.arm_state import State
from limber.model.rotations import between, quaternion_about

from .config import LimberFollowerConfig
from .keys import FORCE, GRIPPER, POSE, STIFFNESS, TIP, Keys

UNTURNED = np.array([1.0, 0.0, 0.0, 0.0])


class LimberFollower(Robot):
    """Every action is one message of a target stream: it never waits, and the goal is smooth
    whatever the loop does. A jump is faded within bounds of speed and acceleration; without actions
    the arm comes to rest and goes on with the next. An arm held after `silence_s` is made active
    beside the loop, whose actions until then are left out.
    """

    config_class = LimberFollowerConfig
    name = "limber_follower"

    _arm: Arm | None = None

    def __init__(self, config: LimberFollowerConfig) -> None:
        super().__init__(config)
        self.config = config
        self.cameras = _cameras(config.cameras)
        self._stream: Any = None
        self._beside: ThreadPoolExecutor
        self._activation: Future[None] | None = None

    @cached_property
    def _keys(self) -> Keys:
        return Keys.of(self.config.arm, self.config.units)

    @property
    def observation_features(self) -> dict[str, Any]:
        names = {name: float for group in self.config.observe for name in self._names(group)}
        images = {
            key: (camera.height, camera.width, 3) for key, camera in self.config.cameras.items()
        }
        return {**names, **images}

    @property
    def action_features(self) -> dict[str, Any]:
        names = self._keys.positions
        if self.config.action == "pose":
            names = POSE + names[len(self._keys.joints) :]
        return dict.fromkeys((*names, *((STIFFNESS,) * self.config.stiffness)), float)

    @property
    def is_connected(self) -> bool:
        return self._arm is not None

    def connect(self, calibrate: bool = True) -> None:
        """Waits for the stack, enables the drives and starts the law; may take 15 s."""
        self._beside = ThreadPoolExecutor(1, "limber_follower")
        self._arm = Arm(self.config.arm if "/" not in self.config.arm else None)
        if "contact" in self.config.observe or "force" in self.config.observe:
            self._arm.gains(contact="joint_torque")
        self._arm.activate()
        self._stream = self._arm.stream(
            self.config.rate_hz,
            delay_s=self.config.delay_s,
            valid_for_s=self.config.silence_s,
        )
        for camera in self.cameras.values():
            camera.connect()

    @property
    def is_calibrated(self) -> bool:
        return True  # robot.yaml holds signs and offsets

    def calibrate(self) -> None:
        """Nothing to do: see `limber check` for an arm's signs and offsets."""

    def configure(self) -> None:
        """Nothing to do: the drives are compared with robot.yaml when they start."""

    def get_observation(self) -> dict[str, Any]:
        state = self._connected().state
        found = {
            name: float(value)
            for group in self.config.observe
            for name, value in zip(self._names(group), self._values(group, state), strict=True)
        }
        return {**found, **{key: camera.async_read() for key, camera in self.cameras.items()}}

    def send_action(self, action: dict[str, Any]) -> dict[str, Any]:
        """Returns what was sent. FaultError in FAULT and ESTOP."""
        arm = self._connected()
        sent = {key: float(action[key]) for key in self.action_features}
        target: dict[str, Any] = {}
        if self.config.action == "pose":
            values = np.array([sent[key] for key in POSE])
            target["position_m"] = values[:3]
            target["quaternion_wxyz"] = quaternion_about(values[3:])
        else:
            pos = np.array([sent[key] for key in self._keys.of_joints("pos")])
            target["joints_rad"] = pos * self._keys.scale
        if GRIPPER in sent:
            target["hand_width_m"] = self._keys.width_m(sent[GRIPPER])
        if self.config.stiffness:
            target["stiffness_scale"] = min(max(sent[STIFFNESS], 0.05), 1.0)
        if arm.mode == "active":
            self._stream.send(**target)
        else:
            self._activate(arm)
        return sent

    def _activate(self, arm: Arm) -> None:
        """Does not wait for it. Raises why it has failed before."""
        check_fault(arm.state)
        before = self._activation
        if before is not None and not before.done():
            return
        self._activation = None
        if before is not None:
            before.result()
        self._activation = self._beside.submit(arm.activate)

    def disconnect(self) -> None:
        """The arm stays held."""
        for camera in self.cameras.values():
            camera.disconnect()
        if self._arm is not None:
            self._beside.shutdown()  # an arm that is being made active is so before it is held
            self._arm.close()
        self._arm, self._activation = None, None

    def _connected(self) -> Arm:
        if self._arm is None:
            raise ConnectionError("limber_follower is not connected: call connect() first")
        return self._arm

    def _names(self, group: str) -> tuple[str, ...]:
        if group == "pos":
            return self._keys.positions
        if group == "tip":
            return TIP
        return FORCE if group == "force" else self._keys.of_joints(group)

    def _values(self, group: str, state: State) -> np.ndarray:
        scale = self._keys.scale
        if group == "pos":
            hand = () if self._keys.hand_width_m is None else (self._width(),)
            return np.array([*(state.q / scale), *hand])
        if group == "vel":
            return np.asarray(state.v / scale)
        if group == "torque":
            return state.tau
        if group == "contact":
            return state.contact_torque
        if group == "force":
            return np.asarray(state.wrench[:3])
        return np.array([*state.pose.p, *between(UNTURNED, state.pose.quat)])

    def _width(self) -> float:
        return self._keys.gripper(self._connected().hand.state.width_m)


def _cameras(configs: dict[str, Any]) -> dict[str, Any]:
    if not configs:
        return {}
    from lerobot.cameras.utils import make_cameras_from_configs

    cameras: dict[str, Any] = make_cameras_from_configs(configs)
    return cameras
