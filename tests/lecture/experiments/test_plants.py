"""The reduced plants that experiments measure on, against closed forms."""

import math

import numpy as np
import pytest

from limber.errors import RunError
from limber_lecture.plants import coulomb_step, growth, held, mass, with_delay
from limber_lecture.search import limit


def test_a_held_force_moves_a_damped_mass_as_the_exponential_says():
    m, b, F, T = 2.0, 3.0, 5.0, 0.4
    A, B = held(*mass(m, b), T)
    x, v = (A @ [0.1, -0.7] + B[:, 0] * F).tolist()
    decay, rest = math.exp(-b * T / m), F / b
    assert v == pytest.approx(rest + (-0.7 - rest) * decay)
    assert x == pytest.approx(0.1 + rest * T + (-0.7 - rest) * m / b * (1 - decay))


@pytest.mark.parametrize("samples", [0, 1, 2, 5])
def test_a_delayed_input_acts_so_many_samples_later(samples):
    A, B = with_delay(*held(*mass(1.0), 1e-2), samples)
    state, moved_at = np.zeros(len(A)), None
    for k in range(10):
        state = A @ state + B[:, 0] * (k == 0)
        if moved_at is None and state[1] != 0:
            moved_at = k
    assert moved_at == samples


def test_growth_of_a_damped_and_of_an_unstable_mass():
    T, m, b, k = 1e-2, 1.0, 0.4, 100.0
    stable, _ = held(*mass(m, b, k), T)
    assert growth(stable) == pytest.approx(math.exp(-b / (2 * m) * T))
    unstable, _ = held(*mass(m, -b, k), T)
    assert growth(unstable) > 1


def test_dry_friction_stops_a_mass_where_its_energy_is_used_up():
    m, F_c, v = 0.5, 2.0, 0.3
    x, rest = coulomb_step(0.0, v, 0.0, F_c, m, 10.0)
    assert (x, rest) == (pytest.approx(m * v * v / (2 * F_c)), 0.0)


def test_dry_friction_holds_up_to_its_size_and_no_further():
    assert coulomb_step(0.2, 0.0, 1.99, 2.0, 0.5, 1.0) == (0.2, 0.0)
    x, v = coulomb_step(0.2, 0.0, -3.0, 2.0, 0.5, 0.1)
    assert (x, v) == (pytest.approx(0.2 - 0.01), pytest.approx(-0.2))


def test_a_mass_thrown_against_a_force_turns_round_within_one_step():
    """Up with (F + F_c)/m, down with (F - F_c)/m."""
    m, F, F_c, v, T = 1.0, -3.0, 1.0, 1.0, 1.0
    up = v / 4
    x, after = coulomb_step(0.0, v, F, F_c, m, T)
    assert after == pytest.approx(-2 * (T - up))
    assert x == pytest.approx(v * v / 8 - (T - up) ** 2)


def test_a_limit_is_where_it_changes_and_nowhere_else():
    assert limit(lambda x: x < math.pi, 0.1, 100.0) == pytest.approx(math.pi, rel=1e-5)
    for holds in (lambda x: True, lambda x: False):
        with pytest.raises(RunError, match="no limit between"):
            limit(holds, 0.1, 100.0)
