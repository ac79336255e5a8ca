"""Names and units of an arm's numbers in LeRobot: `joint_1.pos` in degrees, ..."""

import math
from dataclasses import dataclass

import numpy as np

from limber.model.robot import load_robot

TIP = ("tip.x", "tip.y", "tip.z", "tip.rx", "tip.ry", "tip.rz")
FORCE = ("tip.fx", "tip.fy", "tip.fz")
POSE = ("ee.x", "ee.y", "ee.z", "ee.wx", "ee.wy", "ee.wz")
STIFFNESS = "stiffness"
GRIPPER = "gripper.pos"


@dataclass(frozen=True)
class Keys:
    """Of one arm. `scale`: LeRobot's unit in limber's, of each joint's position."""

    joints: tuple[str, ...]
    scale: np.ndarray
    hand_width_m: float | None  # when it is open; None: the arm has no hand
    in_rad: bool

    @classmethod
    def of(cls, arm: str, units: str) -> "Keys":
        robot = load_robot(arm)
        rotary = np.array([joint["type"] != "prismatic" for joint in robot.resolved["joints"]])
        degrees = units == "degrees"
        scale = np.where(rotary & degrees, math.radians(1.0), 1.0)
        width_m = None if robot.hand is None else float(robot.hand.width_m.max())
        names = tuple(f"joint_{i + 1}" for i in range(len(robot.joints)))
        return cls(names, scale, width_m, not degrees)

    def of_joints(self, group: str) -> tuple[str, ...]:
        return tuple(f"{joint}.{group}" for joint in self.joints)

    @property
    def positions(self) -> tuple[str, ...]:
        """Of the joints, and the gripper if there is one."""
        return self.of_joints("pos") + (() if self.hand_width_m is None else (GRIPPER,))

    def gripper(self, width_m: float) -> float:
        """0 closed to 100 open; in m with rad."""
        if self.in_rad or not self.hand_width_m:
            return width_m
        return 100.0 * width_m / self.hand_width_m

    def width_m(self, gripper: float) -> float:
        widest_m = self.hand_width_m or 0.0
        width_m = gripper if self.in_rad else gripper / 100.0 * widest_m
        return min(max(width_m, 0.0), widest_m)
