"""What a frame tells of one motor, in the joint's units and with the joint's sign."""

from enum import Enum
from typing import NamedTuple


class Kind(Enum):
    """What a command makes the drive do."""

    FOLLOW = "follow"  # a torque and nothing else
    HOLD = "hold"  # the drive's own stiffness or damping as well
    DAMP = "damp"  # damping alone
    ENABLE = "enable"
    DISABLE = "disable"
    REQUEST = "request"  # asks, commands nothing
    INVALID = "invalid"

    @property
    def stops(self) -> bool:
        """The drive no longer follows a controller."""
        return self in (Kind.HOLD, Kind.DAMP, Kind.DISABLE, Kind.REQUEST)

    @property
    def commands(self) -> bool:
        return self in (Kind.FOLLOW, Kind.HOLD, Kind.DAMP)


class Command(NamedTuple):
    """rad, rad/s, N m; kp in N m/rad, kd in N m s/rad. `text`: why it is INVALID."""

    time_ns: int
    kind: Kind
    torque: float = 0.0
    position: float = 0.0
    velocity: float = 0.0
    kp: float = 0.0
    kd: float = 0.0
    text: str = ""


class State(NamedTuple):
    """rad and rad/s. `failed`: the drive reports an error, or stopped by itself.

    `motor_velocity`: behind the gear; another one where a spring lies between it and the link.
    """

    time_ns: int
    position: float
    velocity: float
    motor_velocity: float
    enabled: bool
    failed: bool


def kind_of(kp: float, kd: float, torque: float, resolution_Nm: float) -> Kind:
    """Of a command with the drive's stiffness and damping; torques below `resolution_Nm` are 0."""
    if kp == 0.0 and kd == 0.0:
        return Kind.FOLLOW
    return Kind.DAMP if kp == 0.0 and abs(torque) <= resolution_Nm else Kind.HOLD
