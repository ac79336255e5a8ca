"""The table of `limber dev bench`, from a report of the benchmarks."""

import pytest
from made_logs import records

from limber.errors import RunError
from limber_qa import bench_receiver
from limber_qa.bench import figures, level_figures, medians_of
from limber_qa.bench_figure import Figure, table
from limber_qa.bench_loop_parts import Window, lateness_figures, window_of
from limber_qa.bench_recorder import interval_figure


def median(name: str, ns: float) -> dict:
    return {"run_name": name, "name": f"{name}_median", "aggregate_name": "median", "cpu_time": ns}


def report(pinocchio: bool) -> dict:
    rows = [median(f"terms/limber/{n}", 100.0 * n) for n in range(1, 17)]
    rows += [median("terms/kdl/7", 7000.0), median("impedance/kdl/7", 9000.0)]
    rows += [median("impedance/limber/7", 1000.0)]
    rows += [median("BM_ControllerCycle/rigid/cartesian_impedance", 2401.0)]
    rows += [median("BM_ControllerCycle/rigid/joint_pd", 3999.0)]
    rows += [median("plant_step/reference", 3000.0), median("plant_step/bare_ode", 10000.0)]
    rows += [median("plant_step/ode", 10900.0), median("lab_cycle/held", 6000.0)]
    rows += [{**median("impedance/limber/7", 5.0), "aggregate_name": "mean"}]
    if pinocchio:
        rows += [median("impedance/pinocchio/7", 4000.0)]
        rows += [median(f"terms/pinocchio/{n}", 400.0 * n) for n in range(1, 17)]
    return {"benchmarks": rows}


def test_ratio_and_verdict():
    rows = medians_of(report(pinocchio=True))
    found = {figure.name: figure for figure in level_figures("avx2", rows)}
    first = found["impedance/limber/7, avx2"]
    assert first.ratio == pytest.approx(0.25)
    assert first.verdict == "met"
    assert found["terms/limber/3, avx2"].peers == 1200.0
    assert found["terms/limber/16, avx2"].ratio == pytest.approx(0.25)
    assert found["BM_ControllerCycle/rigid/cartesian_impedance, avx2"].goal == 0.9
    assert found["BM_ControllerCycle/rigid/joint_pd, avx2"].goal == 1.5
    lab = figures(rows)[-1]
    assert lab.ratio == pytest.approx(6000.0 / (3000.0 + 1000.0))
    assert lab.verdict == "met"


def test_more_is_asked_of_wider_registers_and_nothing_of_the_plain_ones():
    rows = medians_of(report(pinocchio=True))
    verdicts = [level_figures(level, rows)[0].verdict for level in ("avx512", "avx2", "plain")]
    assert verdicts == ["missed", "met", ""]


def test_without_the_peer_nothing_is_judged():
    rows = medians_of(report(pinocchio=False))
    found = level_figures("avx2", rows)
    assert {figure.verdict for figure in found if "pinocchio" in figure.peer} == {
        "peer not installed"
    }
    assert all(figure.ratio is not None for figure in figures(rows))


def test_mujoco_is_a_peer_where_it_is_installed():
    rows = medians_of(report(pinocchio=True))
    name = "plant_step/mujoco"
    (without,) = (f for f in level_figures("avx2", rows) if f.peer == name)
    assert without.verdict == "peer not installed"
    (found,) = (f for f in level_figures("avx2", {**rows, name: 5000.0}) if f.peer == name)
    assert found.ratio == pytest.approx(0.6)
    assert found.verdict == "met"


def test_json_holds_what_the_table_shows():
    figure = Figure("a", 300.0, "b", 100.0, 2.0)
    row = figure.as_json()
    assert row["ratio"] == pytest.approx(3.0)
    assert row["verdict"] == "missed"
    assert row["unit"] == "ns"
    assert figure.shown(figure.own) == "0.30"  # µs
    assert Figure(**figure.as_row()) == figure


def test_without_a_peer_the_figure_itself_is_judged():
    none = Figure("locks", 0, goal=0.0, unit="calls")
    assert none.ratio is None
    assert none.verdict == "met"
    assert Figure("locks", 1, goal=0.0, unit="calls").verdict == "missed"
    assert Figure("locks", 1, unit="calls").verdict == ""
    assert Figure("locks", 12_345, unit="calls").shown(12_345) == "12345"
    assert table([none, Figure("a", 1.0, "b", None, 1.0)]).row_count == 2


CYCLICTEST = """# /dev/cpu_dma_latency set to 0us
# Histogram
000000 000000
000009 000900
000020 000089
000300 000006
001000 000002
019999 000000
# Total: 000000997
# Min Latencies: 00009
# Histogram Overflows: 00003
# Histogram Overflow at cycle number:
# Thread 0: 00382 00524 00525
"""


def test_cyclictest_is_read():
    """The 990th of a thousand; what is late by a period, in the histogram and beyond."""
    assert window_of(CYCLICTEST) == Window(p99_ns=300_000.0, overruns=5)
    assert window_of("000007 000100\n# Histogram Overflows: 00000\n") == Window(7000.0, 0)


def test_late_windows_are_compared_by_their_median_and_all_overruns_count():
    own = [Window(1000.0, 1), Window(900_000.0, 0), Window(2000.0, 0)]
    peers = [Window(40_000.0, 0)] * 3
    late, over = lateness_figures(own, peers, "cyclictest")
    assert late.ratio == pytest.approx(0.05)
    assert late.verdict == "met"
    assert over.verdict == "missed"  # one where the peer had none
    assert lateness_figures(peers, peers, "cyclictest")[1].verdict == "met"


def test_ten_times_the_rate_is_a_tenth_of_the_interval():
    assert interval_figure(100_000.0, 10_000.0).ratio == pytest.approx(0.1)
    assert interval_figure(100_000.0, 10_000.0).own == pytest.approx(10_000.0)
    assert interval_figure(100_000.0, 20_000.0).verdict == "missed"


def test_every_reader_reads_every_message():
    rows = {name: records(f"{name.lower()}_t", 25) for name in ("JOINT_STATE", "SIM_TRUTH")}
    found = {name: [row.tobytes() for row in made] for name, made in rows.items()}
    assert bench_receiver.live(found) == bench_receiver.decoded(found) == 50


def test_readers_take_turns():
    calls = []
    ns = bench_receiver.least_ns(dict.fromkeys("ab", lambda: calls.append(1) or 10))
    assert len(calls) == 2 * bench_receiver.TURNS
    assert set(ns) == {"a", "b"}


def test_readers_are_compared_with_lcm_gens_decode():
    live, log = bench_receiver.figures({"live": 900.0, "log": 1100.0, "decode": 10_000.0})
    assert live.ratio == pytest.approx(0.09)
    assert live.verdict == "met"
    assert log.verdict == "missed"


def test_a_benchmark_that_failed_is_an_error():
    bad = {"name": "impedance/kdl/7", "error_occurred": True, "error_message": "the torques differ"}
    with pytest.raises(RunError, match="impedance/kdl/7: the torques differ"):
        medians_of({"benchmarks": [bad]})
