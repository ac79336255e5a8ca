"""Which values the runs have: by closed forms, and by the seed alone."""

import numpy as np
import pytest

from limber.errors import InputError
from limber.sweep.sample import seed_of, shares
from limber.sweep.variation import parse

TWO = (parse("a=0..1"), parse("b=0..1"))


def test_each_stratum_of_a_latin_hypercube_holds_one_run():
    runs = 97
    found = shares("lhs", (*TWO, parse("c=0..1")), runs, seed=3)
    assert found.shape == (runs, 3)
    for column in found.T:
        assert sorted(np.floor(column * runs).astype(int)) == list(range(runs))
    assert abs(np.corrcoef(found.T) - np.eye(3)).max() < 0.35, "the columns are no copies"


def test_a_monte_carlo_sample_is_uniform_and_independent():
    found = shares("monte-carlo", TWO, 20_000, seed=3)
    assert found.min() >= 0 and found.max() < 1
    assert found.mean(axis=0) == pytest.approx([0.5, 0.5], abs=0.01)  # sigma 0.002
    assert found.var(axis=0) == pytest.approx([1 / 12, 1 / 12], rel=0.03)
    assert abs(np.corrcoef(found.T)[0, 1]) < 0.03


@pytest.mark.parametrize("method", ["lhs", "monte-carlo"])
def test_the_seed_alone_decides(method):
    first = shares(method, TWO, 50, seed=1)
    np.testing.assert_array_equal(first, shares(method, TWO, 50, seed=1))
    assert not np.isin(first, shares(method, TWO, 50, seed=2)).any()


def test_a_grid_has_the_ends_and_every_word():
    words = parse("w=x,y")
    found = shares("grid", (TWO[0], words, TWO[1]), 20, seed=1)  # 2 words: 3 x 3 points fit
    assert len(found) == 18 and len(np.unique(found, axis=0)) == 18
    assert sorted(set(found[:, 0])) == [0, 0.5, 1]
    assert {words.at(share) for share in found[:, 1]} == {"x", "y"}
    again = shares("grid", (TWO[0], words, TWO[1]), len(found), seed=1)
    np.testing.assert_array_equal(again, found)


def test_a_grid_that_does_not_fit_is_refused():
    with pytest.raises(InputError, match="--runs 3: this grid has 4 runs or more"):
        shares("grid", TWO, 3, seed=1)
    with pytest.raises(InputError, match="--runs 2: this grid has 3 runs or more"):
        shares("grid", (parse("w=1,2,3"),), 2, seed=1)


def test_seeds_of_runs_differ():
    assert len({seed_of(sweep, run) for sweep in (1, 2) for run in range(500)}) == 1000
