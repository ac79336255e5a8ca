"""The words of --vary: what they mean, and what is refused."""

import numpy as np
import pytest

from limber.errors import InputError
from limber.sweep.variation import parse, unit_of

WRONG = [
    ("seed", "expected KEY=LOW..HIGH"),
    ("=1..2", "expected KEY=LOW..HIGH"),
    ("seed=", "expected KEY=LOW..HIGH"),
    ("seed=1,x", "expected numbers, or true and false, or words"),
    ("duration_s=2..1", "expected LOW below HIGH"),
    ("duration_s=1..1", "expected LOW below HIGH"),
    ("duration_s=1..nan", "'nan'; expected a number in s"),
    ("payload_kg=0..2lb", "'2lb'; expected a number in kg, without it"),
    ("duration_s=0..2:log", "LOW:log above 0"),
    ("duration_s=1..2:ln", "expected KEY=LOW..HIGH"),
]


@pytest.mark.parametrize(("text", "said"), WRONG)
def test_refusals(text, said):
    with pytest.raises(InputError) as refused:
        parse(text)
    assert f"--vary {text}: " in str(refused.value) and said in str(refused.value)


def test_ranges_lists_and_short_names():
    found = parse("gains.K_x=100..2000")
    assert (found.key, found.low, found.high) == ("gains.K_x_translation_N_per_m", 100, 2000)
    assert found.text == "gains.K_x_translation_N_per_m=100..2000"
    found = parse("loss=1e-4..1e-2:log")
    assert (found.key, found.low, found.high, found.how) == ("wire.loss", 1e-4, 1e-2, "log")
    assert parse("bus_delay=0..0.001").key == "wire.delay_s"
    assert parse("a=0,0.5,1e3").values == (0, 0.5, 1000)
    assert parse("a=true,false").values == (True, False)
    assert parse("a=x").values == ("x",)
    for text in ("a.b=-1..2.5", "a.b=0.1..10:log", "a=1..3:whole", "a.b=1,2.5", "a=x,y"):
        assert parse(parse(text).text) == parse(text)


def test_values_along_the_way():
    assert [parse("a=2..4").at(share) for share in (0, 0.25, 1)] == [2, 2.5, 4]
    assert parse("a=1..100:log").at(0.5) == pytest.approx(10)  # the geometric mean
    assert parse("a=x,y").at(1.0) == "y"
    whole = parse("a=3..6:whole")
    values = [whole.at(share) for share in (np.arange(400) + 0.5) / 400]
    assert all(type(value) is int for value in values)
    assert [values.count(n) for n in (3, 4, 5, 6)] == [100] * 4
    assert (whole.at(0.0), whole.at(1.0)) == (3, 6)


@pytest.mark.parametrize(
    ("key", "unit"),
    [
        ("gains.K_x_translation_N_per_m", "N/m"),
        ("gains.K_q_Nm_per_rad.2", "N m/rad"),
        ("gains.velocity_acceleration_rad_per_s2", "rad/s²"),
        ("payload.mass_kg", "kg"),
        ("duration_s", "s"),
        ("gains.damping_ratio", ""),
        ("seed", ""),
    ],
)
def test_units_are_those_in_the_names(key, unit):
    assert unit_of(key) == unit
