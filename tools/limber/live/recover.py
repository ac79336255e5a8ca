"""`limber send recover`: the way from a fault to a running law, in one command."""

from limber.live.arm import Arm
from limber.live.arm_state import State
from limber.messages import SEND_CLIENT
from limber.model.robot import load_robot


def recover(robot: str | None, release: bool | None) -> State:
    """`robot`: name or folder, refuses any other; `release`: as of Arm.recover. The arm stays
    ACTIVE, under the lease of `limber send`.
    """
    arm = Arm(None if robot is None else load_robot(robot).name, client=SEND_CLIENT)
    try:
        arm.recover(release=release)
        return arm.state
    finally:
        arm.detach()
