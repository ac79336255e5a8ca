"""A check passes when the numbers agree, and never when one of them is no number."""

import json
import math

import pytest

from limber.errors import InputError
from limber_lecture.comparison import KINDS, Comparison


def made(kind: str, predicted: float, measured: float, tolerance: float = 0.1) -> Comparison:
    return Comparison("x", predicted, measured, "N", tolerance, kind)


@pytest.mark.parametrize(
    ("kind", "predicted", "inside", "outside"),
    [
        ("relative", 200.0, (180.5, 219.5), (179.5, 220.5)),
        ("relative", -200.0, (-219.5, -180.5), (-220.5, 200.0)),
        ("absolute", 0.0, (-0.09, 0.09), (-0.11, 0.11)),
        ("at_most", 5.0, (-100.0, 5.09), (5.11, 1e9)),
        ("at_least", 5.0, (4.91, 1e9), (4.89, -100.0)),
    ],
)
def test_agreement(kind, predicted, inside, outside):
    assert all(made(kind, predicted, value).passed for value in inside)
    assert not any(made(kind, predicted, value).passed for value in outside)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_what_is_no_number_never_passes(kind, value):
    for check in (made(kind, 1.0, value), made(kind, value, 1.0), made(kind, value, value)):
        assert not check.passed
        content = json.loads(json.dumps(check.as_json(), allow_nan=False))
        assert content["pass"] is False


def test_json_has_the_agreed_keys():
    content = made("absolute", 1.0, math.nan).as_json()
    assert {"name", "predicted", "measured", "unit", "tolerance", "pass"} <= set(content)
    assert content["measured"] is None


@pytest.mark.parametrize(
    ("kind", "predicted", "tolerance"),
    [("about", 1.0, 0.1), ("relative", 0.0, 0.1), ("absolute", 1.0, -0.1)]
    + [("absolute", 1.0, value) for value in (math.nan, math.inf)],
)
def test_senseless_checks_are_refused(kind, predicted, tolerance):
    with pytest.raises(InputError, match="check 'x'"):
        made(kind, predicted, 1.0, tolerance)
