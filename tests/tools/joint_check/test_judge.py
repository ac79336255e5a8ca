"""Who turned what: every verdict, and everything a hand, a heavy arm or a bus adds to it."""

import numpy as np
import pytest

from limber.joint_check.judge import Finding, Step, Verdict, amounts, direction

PERIOD_S = 0.05


class Hand:
    """Gives a step the readings of an arm, twenty a second."""

    def __init__(self, step: Step, start: np.ndarray | None = None) -> None:
        self.step = step
        n = len(step.amounts)
        self.q = np.linspace(-0.3, 0.4, n) if start is None else np.array(start, float)
        self.fresh = np.ones(n, bool)
        self.link = np.zeros(n)  # a link's encoder reads so much of the motor's turn more
        self.link_offset = 0.0
        self.time_s = 5.0

    def hold(self, for_s: float, rate: np.ndarray | float = 0.0, noise=None) -> Finding | None:
        """The joints move at `rate`, rad/s; ends with a finding."""
        for _ in range(round(for_s / PERIOD_S)):
            self.time_s += PERIOD_S
            self.q = self.q + PERIOD_S * np.asarray(rate)
            read = self.q + (0.0 if noise is None else noise(len(self.q)))
            apart = self.link_offset + self.link * self.q
            if (found := self.step.take(self.time_s, read, self.fresh, apart)) is not None:
                return found
        return None

    def turn(self, change: dict[int, float], in_s: float = 1.0, **more) -> Finding | None:
        rate = np.zeros(len(self.q))
        for joint, amount in change.items():
            rate[joint] = amount / in_s
        return self.hold(in_s, rate, **more) or self.hold(0.5, **more)


def hand(joint: int, n: int = 7, way: int = 1, amount: float = 0.2) -> Hand:
    """The arm is at rest."""
    made = Hand(Step(joint, way, np.full(n, amount)))
    assert not made.step.at_rest
    assert made.hold(0.6) is None
    assert made.step.at_rest
    return made


@pytest.mark.parametrize("n", range(1, 17))
def test_right(n):
    for joint in {0, n // 2, n - 1}:
        found = hand(joint, n).turn({joint: 0.23})
        assert found.verdict is Verdict.OK and found.joints == (joint,)
        assert 0.2 <= found.moved <= 0.23


@pytest.mark.parametrize(
    ("way", "change", "verdict"),
    [(1, -0.22, Verdict.SIGN), (-1, -0.22, Verdict.OK), (-1, 0.22, Verdict.SIGN)],
)
def test_the_other_way(way, change, verdict):
    found = hand(3, way=way).turn({3: change})
    assert found.verdict is verdict and np.sign(found.moved) == np.sign(change)


def test_another_motor():
    found = hand(3).turn({4: -0.22})
    assert found.verdict is Verdict.EXCHANGED
    assert found.joints == (4,) and found.moved < 0


def test_two_at_once():
    found = hand(3).turn({3: 0.22, 1: 0.1})
    assert found.verdict is Verdict.SEVERAL and found.joints == (3, 1)


def test_a_third_is_the_bound():
    assert hand(3).turn({3: 0.24, 2: 0.07, 4: -0.07}).verdict is Verdict.OK
    assert hand(3).turn({3: 0.24, 4: -0.1}).verdict is Verdict.SEVERAL
    assert hand(3).turn({3: 0.5, 4: 0.15}, in_s=0.2).verdict is Verdict.OK, "of what it moved by"


def test_too_little_is_waited_for():
    waiting = hand(2)
    assert waiting.turn({2: 0.15}) is None
    assert waiting.turn({2: 0.08}).verdict is Verdict.OK


def test_noise_alone_is_no_turn():
    rng = np.random.default_rng(1)

    def noise(n):
        return rng.normal(0.0, 0.001, n)

    arm = Hand(Step(1, 1, np.full(5, 0.2)))
    assert arm.hold(20.0, noise=noise) is None
    assert arm.step.at_rest
    assert arm.turn({1: 0.23}, noise=noise).verdict is Verdict.OK


def test_one_wild_reading_is_no_turn():
    arm = hand(1, 5)
    arm.q[4] += 1.0
    assert arm.hold(PERIOD_S) is None
    arm.q[4] -= 1.0
    assert arm.hold(1.0) is None


def test_a_knock_is_no_turn():
    """Three readings, a tenth of a second in all."""
    arm = hand(1, 5)
    for _ in range(10):
        arm.q[1] += 0.3
        assert arm.hold(3 * PERIOD_S) is None
        arm.q[1] -= 0.3
        assert arm.hold(3 * PERIOD_S) is None
    arm.q[1] += 0.3
    assert arm.hold(0.3).verdict is Verdict.OK


def test_the_driver_was_started_again():
    """Its time begins anew: what was heard before no longer counts."""
    arm = Hand(Step(0, 1, np.full(2, 0.2)))
    arm.hold(0.3)
    arm.time_s = 0.0
    assert arm.hold(0.4) is None and not arm.step.at_rest
    arm.hold(0.3)
    assert arm.step.at_rest


def test_the_arm_has_to_be_at_rest_first():
    arm = Hand(Step(0, 1, np.full(2, 0.2)))
    assert arm.hold(3.0, np.array([0.3, 0.0])) is None
    assert not arm.step.at_rest and arm.step.moving == (0,)
    arm.hold(0.6)
    assert arm.step.at_rest and arm.step.moving == ()


def test_another_joint_drifts_slowly_for_minutes():
    """Further in all than a turn: it is followed, and the turn still counts."""
    arm, drift = hand(2), np.zeros(7)
    drift[5] = -0.004
    assert arm.hold(120.0, drift) is None
    assert arm.turn({2: 0.23}).verdict is Verdict.OK


def test_an_arm_that_sags_fast_is_no_finding_about_the_joint():
    arm = hand(2)
    assert arm.turn({2: 0.23, 1: 0.15, 3: -0.12}).verdict is Verdict.SEVERAL


def test_the_joint_sags_and_is_then_turned_back_and_on():
    arm, sag = hand(2), np.zeros(7)
    sag[2] = -0.008
    assert arm.hold(60.0, sag) is None
    assert arm.turn({2: 0.23}).verdict is Verdict.OK


@pytest.mark.parametrize("joint", [3, 5])
def test_without_a_fresh_reading_nothing_is_concluded(joint):
    arm = hand(3)
    arm.fresh[joint] = False
    assert arm.turn({3: 0.3}) is None
    assert arm.step.missing == (joint,) and not np.isfinite(arm.step.change[joint])
    arm.fresh[joint] = True
    assert arm.hold(0.5).verdict is Verdict.OK


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_not_finite(value):
    arm = hand(3)
    before, arm.q[1] = arm.q[1], value
    assert arm.turn({3: 0.3}) is None and arm.step.missing == (1,)
    arm.q[1] = before
    assert arm.hold(0.5).verdict is Verdict.OK


def test_a_joint_that_never_answers():
    arm = Hand(Step(0, 1, np.full(3, 0.2)))
    arm.fresh[2] = False
    assert arm.hold(10.0) is None
    assert not arm.step.at_rest and arm.step.missing == (2,)


def test_time_that_stands_still_is_no_reading():
    arm = hand(0, 2)
    arm.q[0] += 0.3
    for _ in range(100):
        assert arm.step.take(arm.time_s, arm.q, arm.fresh) is None


def test_rotary_and_prismatic_joints_compare():
    """20 mm are as much as 0.2 rad: a slide that moves 5 mm meanwhile is no second joint."""
    step = Step(0, 1, np.array([0.2, 0.02]))
    arm = Hand(step, np.zeros(2))
    arm.hold(0.6)
    assert arm.turn({0: 0.22, 1: 0.005}).verdict is Verdict.OK
    slide = Hand(Step(1, -1, np.array([0.2, 0.02])), np.zeros(2))
    slide.hold(0.6)
    found = slide.turn({1: -0.022, 0: 0.02})
    assert found.verdict is Verdict.OK and found.moved == pytest.approx(-0.0215, abs=0.0015)


def test_amounts():
    found = amounts(np.array([False, True, False]), np.array([np.inf, 0.03, 0.3]), 0.2, 0.02)
    np.testing.assert_allclose(found, [0.2, 0.01, 0.1])


@pytest.mark.parametrize(
    ("q", "way"), [(0.0, 1), (0.9, -1), (0.79, 1), (-0.95, 1), (1.3, -1), (np.nan, 1)]
)
def test_the_direction_that_has_room(q, way):
    assert direction(q, -1.0, 1.0, 0.2) == way


@pytest.mark.parametrize(
    ("share", "change", "verdict"),
    [
        (0.3, 0.22, Verdict.OK),  # a spring
        (-0.3, 0.22, Verdict.OK),
        (-2.0, 0.22, Verdict.LINK),  # the link's encoder counts the other way
        (-1.0, 0.22, Verdict.LINK),  # it is another joint's
        (-2.0, -0.22, Verdict.SIGN),  # the motor's sign is wrong, and not the link's
        (0.0, -0.22, Verdict.SIGN),
    ],
)
def test_an_encoder_on_the_link_goes_along(share, change, verdict):
    made = hand(3)
    made.link[3] = share
    made.link_offset = -share * made.q[3]
    assert made.turn({3: change}).verdict is verdict


def test_where_the_links_encoder_has_its_zero_does_not_matter():
    made = Hand(Step(3, 1, np.full(7, 0.2)))
    made.link_offset = 1.5
    made.hold(0.6)
    assert made.turn({3: 0.22}).verdict is Verdict.OK


def test_a_links_encoder_without_a_number_is_none():
    made = hand(3)
    made.link_offset = np.nan
    assert made.turn({3: 0.22}).verdict is Verdict.LINK
