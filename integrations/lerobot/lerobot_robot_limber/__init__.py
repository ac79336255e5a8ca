"""limber's arm for LeRobot: `--robot.type=limber_follower`, `--teleop.type=limber_leader`."""

from .config import LimberFollowerConfig, LimberLeaderConfig
from .follower import LimberFollower
from .leader import LimberLeader

__all__ = ["LimberFollower", "LimberFollowerConfig", "LimberLeader", "LimberLeaderConfig"]
