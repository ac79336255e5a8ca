"""A hand that turns one joint of a simulated arm without weight: friction holds the others."""

import time

import numpy as np

from limber.lcmtypes.push_t import push_t
from limber.model.robot import load_robot
from limber.model.urdf import MOVING
from stack import Stack

SPEED = 0.4  # rad/s
PERIOD_S = 0.02


class Hand:
    """Turns a joint by torques on its link and, the other way, on the one before."""

    def __init__(self, stack: Stack, robot: str) -> None:
        self.stack = stack
        self.robot = load_robot(robot)
        self.friction = [joint["friction"] for joint in self.robot.resolved["joints"]]
        self.links = [j.child for j in self.robot.chain.joints if j.kind in MOVING]
        self.number = 0

    def turn(self, joint: int, change: float) -> None:
        """The joint is then let go; what it is short of its goal is friction's."""
        start = self.q()[joint]
        begun_s, end_s = time.monotonic(), abs(change) / SPEED + 0.3
        while (passed_s := time.monotonic() - begun_s) < end_s:
            goal = start + np.sign(change) * min(SPEED * passed_s, abs(change))
            self._push(joint, self._torque(joint, goal, np.sign(change)))
            time.sleep(PERIOD_S)
        self._push(joint, 0.0)

    def q(self) -> np.ndarray:
        return np.array(self.stack.truth.q[: len(self.links)])

    def _torque(self, joint: int, goal: float, way: float) -> float:
        """Friction of the motion, and a spring to the goal."""
        friction = self.friction[joint]
        steady = friction["coulomb_Nm"] + friction["viscous_Nms_per_rad"] * SPEED
        truth = self.stack.truth
        away = goal - truth.q[joint]
        return 0.9 * way * steady + steady * float(np.clip(away / 0.05, -1.5, 1.5))

    def _push(self, joint: int, torque: float) -> None:
        axis = self.robot.dynamics.frames(self.q()[None]).z[joint, 0]
        self._send(1, self.links[joint], torque * axis)
        if joint > 0:
            self._send(2, self.links[joint - 1], -torque * axis)

    def _send(self, number: int, link: str, torque: np.ndarray) -> None:
        self.number += 1
        message = push_t()
        message.seq, message.id, message.link = self.number, number, link
        message.wrench = [0.0, 0.0, 0.0, *torque.tolist()]
        message.duration_s = 0.2  # a hand whose test has stalled lets go
        self.stack.user.lcm.publish("PUSH", message.encode())
