"""What is believed wrongly is refused, with the reason, and never turned into a number."""

from dataclasses import replace

import pytest
from hidden_arm import random_arm, record, write_robot

from limber.identify import friction, torque_constant
from limber.identify.arm import load_arm
from limber.identify.motion import motion_of

SENSORS, WRONG_WEIGHTS = 3, 2  # seeds


@pytest.fixture
def case(tmp_path):
    def make(seed: int, sign: float = 1.0):
        hidden = random_arm(seed)
        recording = record(hidden, 1)
        arm = load_arm(str(write_robot(hidden, tmp_path)))
        return arm, motion_of([replace(recording, motor=sign * recording.motor)])

    return make


def test_a_motor_that_counts_the_other_way(case):
    """A negative constant is never proposed, nor a friction that drives."""
    arm, motion = case(SENSORS, sign=-1.0)
    found = torque_constant.identify(arm, motion)
    assert not found.values
    assert any("check sign and gear ratio" in reason for reason in found.refused.values())
    laws = friction.identify(arm, motion)
    assert not [v for v in laws.values if v.name.startswith("friction:") and v.path]


def test_weights_that_are_said_to_be_known_and_are_not(case):
    arm, motion = case(WRONG_WEIGHTS)
    found = torque_constant.identify(arm, motion, 0.01)
    contradicted = [r for r in found.refused.values() if "other weights" in r]
    assert len(contradicted) >= 3
    assert all("identify gravity first" in reason for reason in contradicted)


def test_without_sensors_somebody_has_to_vouch_for_the_weights(case):
    arm, motion = case(WRONG_WEIGHTS)
    found = torque_constant.identify(arm, motion)
    assert not found.values and len(found.refused) == len(arm.joints)
