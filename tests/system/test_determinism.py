"""Lock step: three processes on the virtual bus and the lab give the same bytes, every time."""

import pytest

from same_bytes import expect_equal, of_the_lab, of_three_processes, shipped, shortened
from stack import ROOT

pytestmark = pytest.mark.lockstep


@pytest.mark.parametrize("name", ["quick", "planar2r_push", "policy"])
def test_same_bytes_every_time(name, tmp_path):
    scenario = ROOT / "scenarios" / f"{name}.yaml"
    lab = of_the_lab(scenario, tmp_path)
    for attempt in ("first", "second"):
        expect_equal(of_three_processes(scenario, tmp_path / attempt), lab, f"{attempt} run")


@pytest.mark.parametrize("name", shipped())
def test_same_bytes_of_every_scenario(name, tmp_path):
    scenario = shortened(name, 2.5, tmp_path)
    lab = of_the_lab(scenario, tmp_path)
    expect_equal(of_three_processes(scenario, tmp_path / "run"), lab, name)
