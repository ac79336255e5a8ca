"""What an action of an environment means: a goal for the stream, and with it an impedance.

`control_mode`, with ManiSkill's names (-1..1 is one step's largest change):

    pd_joint_pos               joint goal, rad or m, within the joints' limits
    pd_joint_delta_pos         change of the joints from where they are
    pd_joint_target_delta_pos  change of the joint goal
    pd_ee_delta_pose           change of the tip pose from where it is, base axes: 3 x m, 3 x rad
    pd_ee_target_delta_pose    change of the tip's goal

`impedance_mode`, in robosuite's order, but of the arm's own units, where robosuite's stiffness is
per unit of inertia (1/s^2):

    fixed        [motion]                 robot.yaml's gains
    variable_kp  [K, motion]              K: of the tip 3 x N/m, 3 x N m/rad; of joints N m/rad
    variable     [ratio, K, motion]       one damping ratio of all modes, where robosuite has six

K lies within `stiffness_range` times robot.yaml's `gains:`, the ratio within RATIOS.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from limber.arrays import Floats
from limber.live import gains_message
from limber.live.values import one_of
from limber.messages import message_class
from limber.model.robot import Robot
from limber.model.rotations import between, product, quaternion_about

CONTROL_MODES = (
    "pd_joint_pos",
    "pd_joint_delta_pos",
    "pd_joint_target_delta_pos",
    "pd_ee_delta_pose",
    "pd_ee_target_delta_pose",
)
IMPEDANCE_MODES = ("fixed", "variable_kp", "variable")
RATIOS = (0.1, 2.0)
# So far may a goal be from where the arm is: what the spring may pull with.
LEASH_M, LEASH_RAD, LEASH_JOINT = 0.1, 0.5, 0.3


@dataclass(frozen=True)
class Where:
    """Joint positions, or tip position, m, and unit quaternion w, x, y, z, base frame."""

    q: Floats
    p: Floats
    quat: Floats


class Actions:
    """`step_m`, `step_rad`, `step_joint`: largest change of a step, m, rad, rad or m."""

    def __init__(
        self,
        robot: Robot,
        control_mode: str,
        impedance_mode: str,
        stiffness_range: tuple[float, float],
        steps: tuple[float, float, float],
    ) -> None:
        one_of("control_mode", control_mode, CONTROL_MODES)
        one_of("impedance_mode", impedance_mode, IMPEDANCE_MODES)
        self.ends = tuple(
            np.array([getattr(joint, end) for joint in robot.joints]) for end in ("low", "high")
        )
        self.at_tip = "_ee_" in control_mode
        self.law = "cartesian_impedance" if self.at_tip else "joint_impedance"
        self._absolute = control_mode == "pd_joint_pos"
        self._from_goal = "_target_" in control_mode
        self._joints = len(robot.joints)
        step_m, step_rad, step_joint = steps
        self._step = np.array([step_m] * 3 + [step_rad] * 3)
        if not self.at_tip:
            self._step = np.full(self._joints, step_joint)
        K = np.diag(robot.K_x) if self.at_tip else robot.K_q
        ones = np.ones(len(self._step))
        low, high = self.ends if self._absolute else (-ones, ones)
        self._ratios = 1 if impedance_mode == "variable" else 0
        self._stiffnesses = 0 if impedance_mode == "fixed" else len(K)
        if self._stiffnesses:
            low = np.concatenate([stiffness_range[0] * K, low])
            high = np.concatenate([stiffness_range[1] * K, high])
        if self._ratios:
            low, high = np.insert(low, 0, RATIOS[0]), np.insert(high, 0, RATIOS[1])
        self.low, self.high = low, high

    def goal(self, action: Floats, at: Where, goal: Where) -> Where:
        """The next goal, from where the arm and its goal are."""
        motion = np.clip(action, self.low, self.high)[self._ratios + self._stiffnesses :]
        if self._absolute:
            return Where(motion, at.p, at.quat)
        start = goal if self._from_goal else at
        change = self._step * motion
        if not self.at_tip:
            q = np.clip(start.q + change, at.q - LEASH_JOINT, at.q + LEASH_JOINT)
            return Where(np.clip(q, *self.ends), at.p, at.quat)
        p = at.p + _shortened(start.p + change[:3] - at.p, LEASH_M)
        turn = between(at.quat, product(quaternion_about(change[3:]), start.quat))
        quat = product(quaternion_about(_shortened(turn, LEASH_RAD)), at.quat)
        return Where(at.q, p, quat / np.linalg.norm(quat))

    def target(self, goal: Where, delay_s: float) -> Any:
        """The goal as a target_stream_t of one knot, from now on."""
        message = message_class("target_stream_t")()
        message.t0_ns = message.NOW
        message.delay_s = delay_s
        message.kind = message.KIND_POSE if self.at_tip else message.KIND_JOINTS
        message.num_joints, message.num_knots = self._joints, 1
        values = [*goal.p.tolist(), *goal.quat.tolist()] if self.at_tip else goal.q.tolist()
        message.value[0][: len(values)] = values
        return message

    def impedance(self, action: Floats) -> Floats:
        """The part of an action for gains(); empty where the impedance is fixed."""
        return np.clip(action, self.low, self.high)[: self._ratios + self._stiffnesses]

    def gains(self, values: Floats, ramp_s: float) -> Any:
        """An impedance as a compliance_gains_t."""
        K = values[self._ratios :]
        given: dict[str, Any]
        if self.at_tip:
            given = {"K_x_translation_N_per_m": K[:3], "K_x_rotation_Nm_per_rad": K[3:]}
        else:
            given = {"K_q_Nm_per_rad": K}
        if self._ratios:
            given["damping_ratio" if self.at_tip else "joint_damping_ratio"] = float(values[0])
        return gains_message.gains(self._joints, None, ramp_s, **given)


def _shortened(vector: Floats, longest: float) -> Floats:
    return vector * min(1.0, longest / max(float(np.linalg.norm(vector)), 1e-12))
