"""The fast experiments, as `limber lecture experiment run` does them: every number agrees."""

import pytest
from rich.console import Console

from limber.paths import ROOT
from limber_lecture.catalog import catalog
from limber_lecture.claims import load_claims
from limber_lecture.run_one import run_one

EXPERIMENTS = catalog()
FAST = [experiment for experiment in EXPERIMENTS if experiment.fast]


@pytest.mark.parametrize("experiment", FAST, ids=lambda experiment: experiment.id)
def test_every_number_agrees(experiment, tmp_path):
    checks = run_one(experiment, tmp_path, Console(quiet=True))
    assert [check for check in checks if not check.passed] == []


def test_every_experiment_has_its_place_in_the_lecture():
    sections, _ = load_claims(ROOT / "lecture" / "experiments" / "claims.yaml")
    assert {experiment.section for experiment in EXPERIMENTS} <= set(sections)
