"""Joints with motors behind springs, as experiments calculate them, against closed forms."""

import math

import numpy as np
import pytest

from limber_lecture.elastic import Drives, State, one_joint, run

M, B, K = 0.5, 0.2, 300.0


def start(q: float = 0.0, theta: float = 0.0) -> State:
    return State(*(np.array([value]) for value in (q, theta, 0.0, 0.0)))


def test_without_torque_link_and_rotor_swing_against_each_other():
    track = run(one_joint(M, B, K, 0.0), lambda t, x: np.zeros(1), 0.5, start=start(theta=0.01))
    omega = math.sqrt(K / M + K / B)
    assert track.tau[:, 0] == pytest.approx(K * 0.01 * np.cos(omega * track.t), abs=1e-9)
    assert (M * track.x.v + B * track.x.theta_dot).max() == pytest.approx(0.0, abs=1e-9)


def test_a_law_at_the_motor_is_in_series_with_the_spring():
    K_P = 500.0

    def law(t: float, x: State) -> np.ndarray:
        return -K_P * x.theta - 12.0 * x.theta_dot

    track = run(one_joint(M, B, K, 4.0), law, 8.0, lambda t: np.array([2.0]))
    assert track.x.q[-1, 0] == pytest.approx(2.0 / K_P + 2.0 / K, rel=1e-6)
    assert track.x.theta[-1, 0] == pytest.approx(2.0 / K_P, rel=1e-6)


@pytest.mark.parametrize("rho", [1.0, 4.0])
def test_a_torque_loop_makes_up_for_a_weak_motor(rho):
    kappa, u = 0.9, 3.0
    held = one_joint(1e9, B, K, 2.0)
    track = run(held, lambda t, x: np.array([u]), 5.0, drives=Drives(rho, kappa=kappa))
    assert track.tau[-1, 0] == pytest.approx(u * kappa * rho / (1 + kappa * (rho - 1)), rel=1e-6)


def test_torque_acts_one_period_late():
    track = run(one_joint(M, B, K, 0.0), lambda t, x: np.array([1.0]), 3e-3)
    assert track.x.theta_dot[1, 0] == 0.0
    assert track.x.theta_dot[2, 0] > 0.0


@pytest.mark.parametrize("push, rest", [(0.9, 0.0), (5.0, 5.0 - 1.0)])
def test_dry_friction_holds_up_to_its_torque(push, rest):
    def law(t: float, x: State) -> np.ndarray:
        return -100.0 * x.theta - 30.0 * x.theta_dot

    drives = Drives(coulomb=1.0)
    track = run(
        one_joint(M, B, 1e4, 20.0), law, 3.0, lambda t: np.array([push * min(t, 1.0)]), drives
    )
    assert 100.0 * track.x.theta[-1, 0] == pytest.approx(rest, abs=4e-2)
