"""What a user may set on LeRobot's command line, such as `--robot.units=rad`."""

from dataclasses import dataclass, field
from typing import Any

from lerobot.robots.config import RobotConfig
from lerobot.teleoperators.config import TeleoperatorConfig

UNITS = ("degrees", "rad")
ACTIONS = ("joints", "pose")
GROUPS = ("pos", "vel", "torque", "contact", "tip", "force")


@RobotConfig.register_subclass("limber_follower")
@dataclass
class LimberFollowerConfig(RobotConfig):
    """`arm`: robot of the running stack, a shipped one or a folder with robot.yaml.

    `observe`: groups of the observation, of pos, vel, torque (measured), contact (estimated torque
    of the world), tip (position, rotation vector), force (of the world at the tip, N). To a policy
    lerobot-rollout hands pos and vel alone.
    `action`: joints, or pose (`ee.x` ... `ee.wz`). `units`: of rotary joints; the gripper is 0
    closed to 100 open, or, with rad, its width in m. `stiffness`: the action has one, as a share of
    the arm's, 0.05 to 1. `rate_hz`: of the loop; `delay_s`: how far behind the action the goal
    runs, by default a period and 10 ms; less extrapolates. `silence_s`: without an action for so
    long the arm is held; before that it comes to rest and waits.
    """

    arm: str = "openarm"
    observe: list[str] = field(default_factory=lambda: ["pos"])
    action: str = "joints"
    units: str = "degrees"
    stiffness: bool = False
    rate_hz: float = 30.0
    delay_s: float | None = None
    silence_s: float = 10.0
    cameras: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        super_init = getattr(super(), "__post_init__", None)
        if super_init is not None:
            super_init()
        for word, words, key in (
            (self.units, UNITS, "units"),
            (self.action, ACTIONS, "action"),
            *((group, GROUPS, "observe") for group in self.observe),
        ):
            if word not in words:
                raise ValueError(f"{key}: {word!r}; expected {', '.join(words)}")


@TeleoperatorConfig.register_subclass("limber_leader")
@dataclass
class LimberLeaderConfig(TeleoperatorConfig):
    """An arm that is moved by hand: its stack runs the law gravity_compensation.

    `gripper_force_N`: with which the hand opens, so that it is pressed together by hand. `url`: LCM
    address of the leader's stack, where it is not this machine's only one.
    """

    arm: str = "openarm"
    units: str = "degrees"
    gripper_force_N: float = 5.0
    url: str | None = None

    def __post_init__(self) -> None:
        if self.units not in UNITS:
            raise ValueError(f"units: {self.units!r}; expected {', '.join(UNITS)}")
        if not self.gripper_force_N > 0.0:
            raise ValueError(f"gripper_force_N: {self.gripper_force_N}; expected more than 0")
