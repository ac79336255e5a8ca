"""Equations of the test bench against closed forms, and how a robot loses a key."""

import math

import numpy as np
import pytest
import yaml

from limber.errors import RunError
from limber_lecture import testbench as bench
from limber_lecture.plants import growth
from limber_lecture.variants import variant

INERTIA, K, D = 0.7, 100.0, 10.0


def test_a_rigid_joint_rings_with_its_spring():
    mode = bench.slowest(bench.looped(bench.rigid(INERTIA), [K, 2.0], 1e-5, 0), 1e-5)
    assert mode.omega == pytest.approx(math.sqrt(K / INERTIA), rel=1e-4)
    assert mode.zeta == pytest.approx(2.0 / (2 * math.sqrt(K * INERTIA)), rel=1e-3)


def test_a_lag_bounds_the_stiffness_by_damping_over_lag():
    plant = bench.lagging(bench.rigid(INERTIA), 5e-3)
    for share, settles in ((0.99, True), (1.01, False)):
        loop = bench.looped(plant, [share * D / 5e-3, D], 1e-5, 0)
        assert (growth(loop) < 1.0) == settles


def test_a_push_bends_law_and_spring_in_series():
    q, v, theta, theta_dot = bench.at_rest(bench.elastic(1000.0), [0.0, 0.0, 500.0, D], 4.0)
    assert q == pytest.approx(4.0 / 500.0 + 4.0 / 1000.0)
    assert theta == pytest.approx(4.0 / 500.0)
    assert abs(v) + abs(theta_dot) < 1e-12


def test_a_held_link_leaves_the_rotor_on_its_spring():
    mode = bench.slowest(bench.looped(bench.held_link(), [0.0, 0.0], 1e-4, 1), 1e-4)
    assert mode.omega == pytest.approx(math.sqrt(bench.K_J / bench.B), rel=1e-9)
    assert mode.zeta == pytest.approx(bench.D_J / (2 * math.sqrt(bench.K_J * bench.B)), rel=1e-9)


def test_a_torque_that_is_late_damps_less():
    now, late = (
        bench.slowest(bench.looped(bench.rigid(INERTIA), [K, 2.0], 1e-3, samples), 1e-3)
        for samples in (0, 1)
    )
    taken = 2 * INERTIA * (now.zeta * now.omega - late.zeta * late.omega)
    assert taken == pytest.approx(K * 1e-3, rel=0.05)


def test_the_zero_of_rates_lies_on_their_line():
    assert bench.zero_between([1.0, 2.0, 4.0], [-3.0, -1.0, 3.0]) == pytest.approx(2.5)
    with pytest.raises(RunError, match="no zero"):
        bench.zero_between([1.0, 2.0], [1.0, 2.0])


def test_none_takes_a_key_from_a_robot(tmp_path):
    robot = variant(tmp_path, bench.ROBOT, bench.joint(**bench.RIGID))
    with open(f"{robot}/robot.yaml", encoding="utf-8") as file:
        joint = yaml.safe_load(file)["joints"][bench.JOINT]
    assert joint["transmission"] == {"kind": "rigid"}
    assert "torque_loop" not in joint and "torque_sensor" in joint


def test_the_link_hangs_at_zero():
    assert bench.weight(0.0, 20.0) == 0.0
    assert bench.weight(np.pi / 2, 20.0) == pytest.approx(20.0)
