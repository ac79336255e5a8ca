"""What the tests of the laws share."""

import json
from pathlib import Path

import numpy as np
import pytest

from arms import Planar2R, UrdfArm
from calculator import PLANAR, SEVEN, plain, run


@pytest.fixture(scope="session")
def evaluate():
    """The outputs of a list of cases, as arrays."""

    def call(cases: list[dict]) -> list[dict]:
        done = run(json.dumps([plain(case) for case in cases]))
        assert done.returncode == 0, done.stderr
        outputs = json.loads(done.stdout)
        return [{key: np.array(value) for key, value in output.items()} for output in outputs]

    return call


@pytest.fixture(params=["planar", "seven"], scope="session")
def arm(request):
    """An arm and how a case names it."""
    if request.param == "planar":
        return Planar2R(), PLANAR
    return UrdfArm(Path(SEVEN["urdf"]), SEVEN["base"], SEVEN["tip"], SEVEN["gravity"]), SEVEN
