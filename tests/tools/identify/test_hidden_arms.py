"""A hundred arms whose truth the identification does not see.

Of what is proposed for them, the truth lies within three standard errors in 95 of 100 cases, and
no proposal explains another motion of the same arm worse than what was believed before.
"""

from collections import defaultdict
from dataclasses import dataclass, field

import numpy as np
import pytest
from hidden_arm import CONSTANT, WEIGHED, HiddenArm, random_arm, record, write_robot

from limber.identify import friction, gravity, stiffness, torque_constant
from limber.identify.arm import Arm, load_arm
from limber.identify.findings import Findings
from limber.identify.gravity import changed_parameters
from limber.identify.motion import Motion, motion_of

ARMS = 100
WITHIN = 3.0  # standard errors
OFTEN = 0.95
NOISE = 1.01  # residuals of another motion are no better known than that


@dataclass
class Tally:
    """`off`: quantity -> differences in standard errors; `worse`: proposals that are."""

    off: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    worse: list[str] = field(default_factory=list)
    proposals: int = 0


@pytest.fixture(scope="module")
def tally(tmp_path_factory) -> Tally:
    found = Tally()
    for seed in range(ARMS):
        hidden = random_arm(seed)
        arm = load_arm(str(write_robot(hidden, tmp_path_factory.mktemp("arm"))))
        motion, other = (motion_of([record(hidden, run)]) for run in (1, 2))
        known = WEIGHED if hidden.weighed else None
        count(found, hidden, friction.identify(arm, motion))
        count(found, hidden, torque_constant.identify(arm, motion, known))
        count(found, hidden, stiffness.identify(arm, motion))
        weights = gravity.identify(arm, motion)
        count(found, hidden, weights)
        for module in (friction, torque_constant):
            judge_joints(found, hidden, arm, other, module.identify(arm, motion, known))
        judge_weights(found, arm, hidden, other, weights)
    return found


def count(tally: Tally, hidden: HiddenArm, found: Findings) -> None:
    """Friction is told in the drive's own N m where the log does not show the torque constant."""
    own = {
        name
        for note in found.notes
        if "do not show in this log" in note
        for name in note.split(":")[0].split(", ")
    }
    for value in found.values:
        joint, body = (part[int(value.joint[1:])] for part in (hidden.joints, hidden.bodies))
        truth = truth_of(value.name, joint, body, joint.kappa if value.joint in own else 1.0)
        if truth is not None:
            kind = value.name.split(" of ")[0]
            tally.off[kind].append((value.value - truth) / value.std)


def truth_of(name: str, joint, body, unit: float) -> float | None:
    section, _, key = name.partition(": ")
    if section == "friction":
        return {
            "coulomb_Nm": joint.coulomb / unit,
            "viscous_Nms_per_rad": joint.viscous / unit,
            "static_Nm": (joint.coulomb + joint.rise) / unit,
            "stribeck_rad_per_s": joint.stribeck if joint.rise > 0 else None,
        }[key]
    if section == "link_friction":
        return 0.0
    if name.startswith("mass of"):
        return body.mass
    if name.startswith("centre of"):
        return float(body.com["xyz".index(name[-1])])
    return {
        "rotor_torque_constant_Nm_per_A": CONSTANT * joint.kappa,
        "stiffness_Nm_per_rad": joint.spring,
        "link encoder later than motor's": joint.delay_s,
        "torque at no load": 0.0 if joint.sensor else joint.offset,
    }[name]
