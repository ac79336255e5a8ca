"""The interval of a share, and a picture for any number of parameters."""

import numpy as np
import pytest

pytest.importorskip("distributed", reason="comes with ./limber test")
import pyarrow

from limber.sweep.definition import Sweep
from limber.sweep.one_run import OUTCOMES
from limber.sweep.picture import Z, draw, wilson
from limber.sweep.sample import shares
from limber.sweep.variation import parse

VARY = (
    parse("gains.K_x=50..2000:log"),
    parse("gains.law=soft,hard"),
    parse("payload_kg=0..2"),
    parse("loss=0,2e-4"),
)


def test_wilson_in_closed_form():
    """At the ends z²/(n + z²), at one half 1/2 ± z/(2 sqrt(n + z²))."""
    n = np.array([1.0, 10.0, 400.0])
    low, high = wilson(0 * n, n)
    np.testing.assert_allclose(low, 0, atol=1e-15)
    np.testing.assert_allclose(high, Z**2 / (n + Z**2))
    low, high = wilson(n, n)
    np.testing.assert_allclose(low, n / (n + Z**2))
    np.testing.assert_allclose(high, 1)
    low, high = wilson(n / 2, n)
    np.testing.assert_allclose(high - 0.5, Z / (2 * np.sqrt(n + Z**2)))
    np.testing.assert_allclose(low + high, 1)


@pytest.mark.parametrize("count", [1, 2, 3, 4])
@pytest.mark.parametrize("runs", [1, 60])
def test_pictures(tmp_path, count, runs):
    vary = VARY[:count]
    sweep = Sweep({}, vary, "lhs", runs, 1, 0.2, {})
    table = shares("lhs", vary, runs, 1)
    columns = {v.key: [v.at(share) for share in table[:, i]] for i, v in enumerate(vary)}
    columns |= {key: [float(x) for x in columns[key]] for key in columns if key == "wire.loss"}
    outcomes = [OUTCOMES[run % 4] for run in range(runs)]
    draw(sweep, pyarrow.table({**columns, "outcome": outcomes}), tmp_path / "sweep.png")
    assert (tmp_path / "sweep.png").read_bytes().startswith(b"\x89PNG")
