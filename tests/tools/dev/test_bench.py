"""The table of `limber bench`, from a report of the benchmarks."""

import pytest

from limber.dev.bench import Figure, figures, medians_of
from limber.errors import RunError


def median(name: str, ns: float) -> dict:
    return {"run_name": name, "name": f"{name}_median", "aggregate_name": "median", "cpu_time": ns}


def report(pinocchio: bool) -> dict:
    rows = [median(f"terms/limber/{n}", 100.0 * n) for n in range(1, 17)]
    rows += [median("terms/kdl/7", 7000.0), median("impedance/kdl/7", 9000.0)]
    rows += [median("impedance/limber/7", 1000.0)]
    rows += [median("BM_ControllerCycle/rigid/cartesian_impedance", 2401.0)]
    rows += [median("BM_ControllerCycle/rigid/joint_pd", 3999.0)]
    rows += [median("plant_step/reference", 3000.0), median("plant_step/bare_ode", 10000.0)]
    rows += [median("plant_step/ode", 10900.0)]
    rows += [{**median("impedance/limber/7", 5.0), "aggregate_name": "mean"}]
    if pinocchio:
        rows += [median("impedance/pinocchio/7", 4000.0)]
        rows += [median(f"terms/pinocchio/{n}", 400.0 * n) for n in range(1, 17)]
    return {"benchmarks": rows}


def test_ratio_and_verdict():
    found = {figure.name: figure for figure in figures(medians_of(report(pinocchio=True)))}
    first = found["terms and Cartesian impedance, 7 joints"]
    assert first.ratio == pytest.approx(0.25)
    assert first.verdict == "met"
    assert found["terms, 16 joints"].ratio == pytest.approx(0.25)
    assert found["whole controller cycle, cartesian_impedance (rigid)"].verdict == "missed"
    assert found["whole controller cycle, joint_pd (rigid)"].verdict == "met"
    step = found["simulated step of 1 ms, rigid arm, Runge-Kutta"]
    assert step.ratio == pytest.approx(0.3)
    assert step.verdict == "missed"
    assert found["the same by ODE"].verdict == "met"


def test_without_the_peer_nothing_is_judged():
    found = figures(medians_of(report(pinocchio=False)))
    assert {figure.verdict for figure in found if "pinocchio" in figure.peer} == {
        "peer not installed"
    }
    assert all(figure.ratio is not None for figure in found if "kdl" in figure.peer)


def test_json_holds_what_the_table_shows():
    row = Figure("a", 300.0, "b", 100.0, 2.0).as_json()
    assert row["ratio"] == pytest.approx(3.0)
    assert row["verdict"] == "missed"


def test_a_benchmark_that_failed_is_an_error():
    bad = {"name": "impedance/kdl/7", "error_occurred": True, "error_message": "the torques differ"}
    with pytest.raises(RunError, match="impedance/kdl/7: the torques differ"):
        medians_of({"benchmarks": [bad]})
