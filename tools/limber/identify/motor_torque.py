"""What a motor's torque turns into on its way to the link."""

import numpy as np

from limber.arrays import Floats
from limber.identify.arm import Arm
from limber.identify.motion import Motion


def sensed(arm: Arm, motion: Motion) -> Floats:
    """What springs and, as far as robot.yaml knows them, dampers pass on to the links, N x n.

    A torque sensor feels the spring; the damper beside it adds D_J (theta' - q').
    """
    damping = [
        joint.believed("transmission", joint.key("damping_Nms_per_rad")) or 0.0
        for joint in arm.joints
    ]
    torque: Floats = motion.tau + np.array(damping) * (motion.theta_dot - motion.v)
    return torque
