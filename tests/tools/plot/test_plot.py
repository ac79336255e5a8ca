"""Plots exist, say what they show in which unit, and hold the numbers of the log."""

import base64
import json
import re

import numpy as np
import pytest
from made_logs import records, write_log
from rich.console import Console

from limber import messages
from limber.log.reader import Log
from limber.messages import message_class
from limber.model.gains_table import law_names
from limber.plot import charts, page, png
from limber.plot.chart import Chart
from limber.plot.commands import plot
from limber.plot.compliance import compliance_charts
from limber.plot.drawing import Drawing, leave_out_constant
from limber.plot.marks import Mark, Span

COUNT = 400


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    time_ns = np.arange(COUNT) * 1_000_000
    joints = {"num_joints": 7, "time_ns": time_ns}
    state = records("joint_state_t", COUNT, **joints)
    state["q"][:, 2] = np.sin(np.arange(COUNT) * 0.05)
    status = records("controller_status_t", COUNT, **joints)
    status["quat_BT"][:, 0] = status["quat_BD"][:, 0] = 1.0
    status["p_BT"][:, 1] = 0.013
    status["tau_gravity"][:, 4] = 2.5
    truth = records("sim_truth_t", COUNT, **joints)
    truth["F_contact"][:, 0] = -7.0
    driver = records("driver_status_t", COUNT // 100, time_ns=time_ns[::100], num_buses=1)
    driver["late_cycles"] = [0, 1, 1, 3]
    path = tmp_path_factory.mktemp("plot") / "run.lcmlog"
    channels = {
        "JOINT_STATE": state,
        "CONTROLLER_STATUS": status,
        "SIM_TRUTH": truth,
        "DRIVER_STATUS": driver,
    }
    return Log(write_log(path, channels))


def drawn(chart, name):
    return np.asarray(chart.series[name])


def test_charts_hold_the_logs_numbers(log):
    position = charts.build(log, "joint", ["a", "b", "elbow"])[0]
    np.testing.assert_allclose(drawn(position, "elbow"), np.sin(np.arange(COUNT) * 0.05))
    assert list(position.series)[3] == "joint 4", "joints without a name are numbered"
    away = next(c for c in charts.build(log, "cartesian") if "away" in c.title)
    np.testing.assert_allclose(drawn(away, "y"), 13.0)
    assert away.unit == "mm"
    torque = charts.build(log, "torque")[4]
    np.testing.assert_allclose(drawn(torque, "gravity"), 2.5)
    counted = next(c for c in charts.build(log, "timing") if c.title.startswith("late,"))
    np.testing.assert_array_equal(drawn(counted, "late cycles"), [0, 1, 1, 3])


def test_springs_only_where_there_are_sensors(log, tmp_path):
    assert charts.build(log, "spring") == [], "no joint of this log says that it has any"
    flags = messages.message_class("joint_state_t")
    state = records("joint_state_t", COUNT, num_joints=3, time_ns=np.arange(COUNT) * 1_000_000)
    state["joint_flags"][:, 1] = flags.JOINT_LINK_ENCODER | flags.JOINT_TORQUE_SENSOR
    state["joint_flags"][:, 2] = flags.JOINT_LINK_ENCODER | flags.JOINT_TWO_MOTORS
    state["theta"][:, 1], state["q"][:, 1] = 0.512, 0.5
    state["tau"][:, 1], state["tau_applied"][:, 1] = 9.0, 10.0
    state["preload"][:, 2] = 0.25
    path = write_log(tmp_path / "run.lcmlog", {"JOINT_STATE": state})
    ahead, torque, preload = charts.build(Log(path), "spring")
    assert list(ahead.series) == ["joint 2", "joint 3"]
    np.testing.assert_allclose(drawn(ahead, "joint 2"), 12.0)
    np.testing.assert_allclose(drawn(torque, "joint 2"), 9.0)
    np.testing.assert_allclose(drawn(torque, "joint 2 asked of the motor"), 10.0)
    assert torque.color_numbers() == [0, 0], "asked and measured go together"
    assert list(preload.series) == ["joint 3"]
    np.testing.assert_allclose(drawn(preload, "joint 3"), 0.25)


def test_contact_only_where_there_is_a_source(log, tmp_path):
    silent = charts.build(log, "torque")
    assert not any("contact" in chart.title for chart in silent)
    assert all("contact" not in chart.series for chart in silent)
    status = records("controller_status_t", COUNT, num_joints=7, contact=1)
    status["time_ns"] = np.arange(COUNT) * 1_000_000
    status["F_ext"][:, 1], status["F_ext"][:, 5] = 3.5, -0.25
    status["tau_ext"][:, 4] = 1.5
    touched = Log(write_log(tmp_path / "run.lcmlog", {"CONTROLLER_STATUS": status}))
    force, torque, *joints = charts.build(touched, "torque")
    assert (force.unit, torque.unit) == ("N", "N m")
    np.testing.assert_allclose(drawn(force, "y"), 3.5)
    np.testing.assert_allclose(drawn(torque, "z"), -0.25)
    np.testing.assert_allclose(drawn(joints[4], "contact"), 1.5)


@pytest.mark.parametrize("topic", [t for t in charts.TOPICS if t not in ("spring", "hand")])
def test_every_axis_has_name_and_unit(log, topic):
    built = charts.build(log, topic)
    fig = png.figure(topic, Drawing("title", {topic: built}))
    assert len(fig.axes) == len(built) >= 3
    for ax, chart in zip(fig.axes, built, strict=True):
        label = ax.get_ylabel().replace("\n", " ")
        assert label == f"{chart.title} ({chart.unit})"
        assert chart.unit
        assert {text.get_text() for text in ax.get_legend().get_texts()} == set(chart.series)
    assert fig.axes[-1].get_xlabel() == built[-1].x
    over_time = [ax for ax, chart in zip(fig.axes, built, strict=True) if chart.over_time]
    assert over_time[-1].get_xlabel() == "arm time (s)"


def test_files(log, tmp_path):
    written = plot(log.path, [], tmp_path, Console(quiet=True))
    assert {p.name for p in written} == {
        *(f"{topic}.png" for topic in charts.TOPICS if topic not in ("spring", "hand")),
        "plot.html",
    }
    for path in written:
        assert path.stat().st_size > 10_000, path


def data_of(page: str) -> dict:
    return json.loads(re.search(r"const data = (\{.*\});\n", page)[1])["run"]


def test_page_needs_nothing_from_outside(log):
    html = page.page(Drawing("a <title>", {"joint": charts.build(log, "joint")}))
    assert not re.search(r"(src|href)\s*=|url\(|@import|fetch\(|XMLHttp", html)
    assert "a &lt;title&gt;" in html
    assert "Permission is hereby granted" in html, "the licence of the drawing code goes with it"
    assert not re.search(r"@[A-Z_]+@", html), "a placeholder was left"


def test_page_holds_the_numbers(log):
    built = charts.build(log, "joint")
    chart = data_of(page.page(Drawing("t", {"joint": built})))["topics"]["joint"][0]
    values = np.frombuffer(base64.b64decode(chart["series"][2]["values"]), "<f4")
    np.testing.assert_allclose(values, np.sin(np.arange(COUNT) * 0.05), atol=1e-6)
    times = np.frombuffer(base64.b64decode(chart["t"]), "<f4")
    np.testing.assert_allclose(times, np.arange(COUNT) * 1e-3, atol=1e-6)


def test_thinning_keeps_every_spike():
    count = 10 * page.MAX_POINTS + 7
    values = np.zeros(count)
    spikes = [0, 12345, 333_333, count - 1]
    values[spikes] = [5, -7, 9, 11]
    chart = Chart("x", "N", np.arange(count) * 1e-3, {"x": values})
    thin = page.thinned(chart)
    assert len(thin.t_s) <= page.MAX_POINTS
    assert {5, -7, 9, 11} <= set(thin.series["x"])
    assert (np.diff(thin.t_s) >= 0).all()


def test_rotation_error_is_the_small_angle_and_blind_to_sign():
    angle = 0.3
    turned = np.array([[np.cos(angle / 2), 0, 0, np.sin(angle / 2)]])
    straight = np.array([[1.0, 0, 0, 0]])
    for sign in (1, -1):
        error = charts.rotation_error(sign * turned, straight)
        np.testing.assert_allclose(error, [[0, 0, angle]], atol=1e-12)
    np.testing.assert_array_equal(charts.rotation_error(np.zeros((1, 4)), straight), 0)


def test_nothing_is_drawn_of_the_time_before_all_drives_have_answered(tmp_path):
    fresh = messages.message_class("joint_state_t").JOINT_FRESH
    time_ns = np.arange(COUNT) * 1_000_000
    state = records("joint_state_t", COUNT, num_joints=2, time_ns=time_ns)
    state["joint_flags"][30:, 0] = state["joint_flags"][50:, 1] = fresh
    state["joint_flags"][200, 1] = 0  # a late reply later on changes nothing
    log = Log(write_log(tmp_path / "run.lcmlog", {"JOINT_STATE": state}))
    position = charts.build(log, "joint")[0]
    assert position.t_s[0] == pytest.approx(0.05)
    assert len(position.t_s) == COUNT - 50 == len(drawn(position, "joint 1"))


def test_lock_step_has_no_charts_of_time(log, tmp_path):
    driver = log.read("DRIVER_STATUS").copy()
    driver["lockstep"] = 1
    channels = {"JOINT_STATE": log.read("JOINT_STATE"), "DRIVER_STATUS": driver}
    channels = {name: as_written(rows, name) for name, rows in channels.items()}
    quiet = Log(write_log(tmp_path / "run.lcmlog", channels))
    assert charts.build(quiet, "timing") == []
    assert {"counted so far", "bus load"} <= {c.title for c in charts.build(quiet, "bus")}
    assert "lateness of the cycle, so far" in {c.title for c in charts.build(log, "timing")}


def as_written(rows, channel):
    """With what the reader takes away: order of bytes and fingerprint."""
    kind = messages.channels()[channel].type_name
    made = np.zeros(len(rows), messages.dtype_of(kind))
    made[messages.FINGERPRINT] = messages.fingerprint_of(kind)
    for field in rows.dtype.names:
        if field != messages.FINGERPRINT:
            made[field] = rows[field]
    return made


def test_torque_of_a_push_is_drawn(tmp_path):
    time_ns = np.arange(COUNT) * 1_000_000
    status = records("controller_status_t", COUNT, time_ns=time_ns)
    status["quat_BT"][:, 0] = status["quat_BD"][:, 0] = 1.0
    truth = records("sim_truth_t", COUNT, time_ns=time_ns)
    truth["F_push"][100:, 4] = 0.5
    channels = {"CONTROLLER_STATUS": status, "SIM_TRUTH": truth}
    built = charts.build(Log(write_log(tmp_path / "run.lcmlog", channels)), "cartesian")
    torque = next(chart for chart in built if "torque of pushes" in chart.title)
    assert torque.unit == "N m" and drawn(torque, "y push").max() == 0.5


def test_stacked_terms_end_where_their_sum_is():
    terms = {"a": np.array([1.0, 2, -1]), "b": np.array([3.0, -1, -2])}
    chart = Chart("torque", "N m", np.arange(3.0), terms, stacked={"a", "b"})
    edges = {name: (low, high) for name, low, high in chart.areas()}
    np.testing.assert_allclose(edges["a"], [[0, 0, 0], [1, 2, -1]])
    np.testing.assert_allclose(edges["b"], [[1, 0, -1], [4, -1, -3]], err_msg="each sign apart")


def lines_at(ax) -> list[float]:
    """Where vertical lines are drawn."""
    return [line.get_xdata()[0] for line in ax.lines if len(set(line.get_xdata())) == 1]


def test_events_and_faults_are_marked_on_every_time_axis(log):
    built = charts.build(log, "cartesian")
    told = [Mark(1, 0.1, "gains: taken", False), Mark(2, 0.3, "gate.STEP: refused", True)]
    drawing = Drawing("run", {"overview": built}, told, [Span(0.0, 0.05, False)])
    fig = png.figure("overview", drawing)
    for ax in fig.axes[: len(built)]:
        assert lines_at(ax) == [0.1, 0.3]
    words = [text.get_text() for text in fig.axes[-1].texts]
    assert any("gains: taken" in line for line in words)
    assert any("0.300 s  gate.STEP: refused" in line for line in words)
    data = data_of(page.page(drawing))
    assert [mark["bad"] for mark in data["marks"]] == [False, True]


def test_verdict_names_what_failed(log):
    good, bad = {"name": "faults", "pass": True}, {"name": "stiffness +x", "pass": False}
    told = {"name": "cycles", "pass": None}
    assert Drawing("", {}, results=[good, told]).verdict == "all 1 checks passed"
    failed = Drawing("", {}, results=[good, bad, told])
    assert failed.verdict == "failed: stiffness +x (1 of 2 checks)"
    assert Drawing("", {}, results=[]).verdict == "", "a log alone is not judged"


def test_another_run_is_drawn_dotted_in_the_same_axes(log):
    chart = Chart("tip", "mm", np.arange(3.0), {"x": np.ones(3), "x goal": np.ones(3)}, {"x goal"})
    slower = Chart("tip", "mm", np.arange(5.0), {"x": 2 * np.ones(5), "x goal": np.ones(5)})
    one, two = (Drawing(n, {"joint": [c]}) for n, c in (("one", chart), ("two", slower)))
    fig = png.figure("joint", one, two)
    dotted = [line for line in fig.axes[0].lines if line.get_linestyle() == ":"]
    assert [list(line.get_ydata()) for line in dotted] == [[2.0] * 5]
    assert dotted[0].get_color() == fig.axes[0].lines[0].get_color()
    assert "dotted: two" in fig.get_suptitle()


def test_tail_is_the_share_of_cycles_that_take_longer():
    step_ms, cycle_ns = np.ones(1000), np.full(1000, 5_000)
    step_ms[:10] = 1.5  # one in a hundred 500 us late
    (tail,) = charts._tail(step_ms, cycle_ns)
    late = np.asarray(tail.series["state later than its period"])
    np.testing.assert_allclose(late[tail.t_s < 499], 0.01)
    assert np.isnan(late[tail.t_s >= 501]).all(), "nothing is that late"
    own = np.asarray(tail.series["controller's own time"])
    assert (own[tail.t_s < 4.9] == 1.0).all() and np.isnan(own[tail.t_s > 5.1]).all()


def test_a_goal_is_not_taken_from_the_time_before_a_state_was_known(tmp_path):
    """Behind springs: the arm is at rest at its goal, and the controller began with zeros."""
    status_t = message_class("controller_status_t")
    status = records("controller_status_t", COUNT, time_ns=np.arange(COUNT) * 1_000_000)
    status["mode"][:50], status["mode"][50:] = status_t.MODE_INIT, status_t.MODE_HOLD
    status["p_BD"][50:, 0] = 0.7
    truth = records("sim_truth_t", COUNT, num_joints=2, time_ns=np.arange(COUNT) * 1_000_000)
    truth["p_BT"][:, 0], truth["theta"][:, 0] = 0.701, 0.02
    path = write_log(tmp_path / "log", {"CONTROLLER_STATUS": status, "SIM_TRUTH": truth})
    built = charts.build(Log(path), "cartesian")
    behind = next(chart for chart in built if "behind the springs" in chart.title)
    np.testing.assert_allclose(drawn(behind, "x"), 1.0, atol=1e-9)


def dithered(count: int = 30_000) -> tuple[np.ndarray, np.ndarray]:
    """A torque that swings by 3 N m, 30 times a second, about a slow ramp, from 10 to 20 s on."""
    t = np.arange(count) * 1e-3
    on = (t > 10) & (t < 20)
    return t, 1.0 + 0.1 * t + 3.0 * on * np.sin(2 * np.pi * 30 * t)


def test_what_swings_is_a_light_band_with_its_mean_on_top():
    t, torque = dithered()
    chart = Chart("torque", "N m", t, {"a": torque, "still": 0.05 * t})
    drawing = Drawing("run", {"torque": [chart]})
    fig = png.figure("torque", drawing)
    (ax,) = fig.axes
    (band,) = ax.collections
    assert band.get_alpha() < 0.4
    edges = band.get_paths()[0].vertices
    assert edges[:, 1].max() == pytest.approx(torque.max(), abs=0.05), "no spike is lost"
    line = next(one for one in ax.lines if one.get_label() == "a")
    middle = (line.get_xdata() > 10.5) & (line.get_xdata() < 19.5)
    slow = 1.0 + 0.1 * line.get_xdata()
    assert np.abs(line.get_ydata() - slow)[middle].max() < 0.5, "the line is the mean"
    assert "light bands" in fig._suptitle.get_text()
    assert len(line.get_xdata()) < 3000


def test_what_is_steep_or_spikes_once_is_no_band():
    t = np.arange(30_000) * 1e-3
    step, spike = np.where(t > 15, 5.0, 0.0), np.zeros(len(t))
    spike[12_345] = 7.0
    slow = np.abs((t % 1.0) - 0.5)  # wide in each bin, but up or down in it
    other = png.figure("x", Drawing("run", {"x": [Chart("x", "N", t, {"slow": slow})]}))
    assert len(other.axes[0].collections) == 0
    fig = png.figure("x", Drawing("run", {"x": [Chart("x", "N", t, {"s": step, "k": spike})]}))
    (ax,) = fig.axes
    assert len(ax.collections) == 0
    assert next(one for one in ax.lines if one.get_label() == "k").get_ydata().max() == 7.0


def test_rest_looks_like_rest_and_zero_is_a_line():
    t = np.arange(100) * 0.01
    noise = 1e-4 * np.sin(t)
    fig = png.figure("x", Drawing("run", {"x": [Chart("v", "rad/s", t, {"a": noise}, least=0.05)]}))
    (ax,) = fig.axes
    low, high = ax.get_ylim()
    assert low <= -0.05 and high >= 0.05
    zero = [one for one in ax.lines if list(one.get_ydata()) == [0.0, 0.0]]
    assert len(zero) == 1


def test_charts_in_which_nothing_changes_are_words(log, tmp_path):
    t = np.arange(3) * 1.0
    still = Chart("temperature", "°C", t, {"a": np.full(3, 30.0), "b": np.full(3, 30.0)})
    moving = Chart("position", "rad", t, {"a": t})
    drawing = Drawing("run", {"joint": [moving, still], "bus": [still]})
    leave_out_constant(drawing, None)
    assert drawing.topics == {"joint": [moving], "bus": [still]}, "no topic is left empty"
    assert drawing.constant == {"joint": ["temperature 30 °C"]}
    assert "temperature 30 °C" in png.figure("joint", drawing)._suptitle.get_text()
    assert data_of(page.page(drawing))["constant"] == {"joint": ["temperature 30 °C"]}
    beside = Drawing("other", {"joint": [moving, Chart("temperature", "°C", t, {"a": t})]})
    both = Drawing("run", {"joint": [moving, still]})
    leave_out_constant(both, beside)
    assert len(both.topics["joint"]) == 2, "it changes in the other run"


def test_a_page_stays_small_however_much_there_is():
    t = np.arange(30_000) * 1e-3
    series = {f"s{i}": np.sin(t * i) for i in range(8)}
    charts_ = [Chart(f"chart {i}", "N", t, series) for i in range(20)]
    html = page.page(Drawing("run", {"torque": charts_}))
    assert len(html) < 3_000_000
    few = data_of(page.page(Drawing("run", {"torque": charts_[:1]})))["topics"]["torque"][0]
    assert len(base64.b64decode(few["t"])) == 4 * 30_000, "where there is room, every sample"


def test_no_name_becomes_markup_or_another_part_of_the_page():
    evil = "</script><!--<script>alert(1)</script>@DATA@"
    chart = Chart(evil, "N", np.arange(3.0), {evil: np.arange(3.0)})
    drawing = Drawing(evil, {"x": [chart]}, [Mark(1, 0.5, evil, True)], constant={"x": [evil]})
    html = page.page(drawing)
    assert html.count("<script") == 2 and html.count("</script") == 2, "those of the page itself"
    assert html.count("<!--") == 1, "the licence"
    data = data_of(html)
    assert data["topics"]["x"][0]["series"][0]["name"] == evil
    assert data["title"] == evil
    png.figure(
        "x",
        Drawing(
            "$\\frac{$ run", {"x": [Chart("$a", "N", np.arange(3.0), {"$x$": np.arange(3.0)})]}
        ),
    )


def test_the_tip_is_drawn_from_its_start(tmp_path):
    """Before the first state there is no tip, and before the first goal no goal."""
    status = records("controller_status_t", COUNT, time_ns=np.arange(COUNT) * 1_000_000)
    status["quat_BT"][100:, 0], status["quat_BD"][200:, 0] = 1.0, 1.0
    status["p_BT"][100:, 0], status["p_BD"][200:, 0] = 0.5, 0.51
    built = charts.build(
        Log(write_log(tmp_path / "log", {"CONTROLLER_STATUS": status})), "cartesian"
    )
    position = next(chart for chart in built if chart.title == "tip position")
    assert position.t_s[0] == pytest.approx(0.1)
    np.testing.assert_allclose(position.series["x"], 0.5)
    desired = position.series["x desired"]
    assert np.isnan(desired[:100]).all() and np.allclose(desired[100:], 0.51)
    away = next(chart for chart in built if chart.title == "tip away from its goal")
    np.testing.assert_allclose(away.series["x"][100:], -10.0)


def test_force_over_displacement_is_the_laws_stiffness(tmp_path):
    """A spring of 400 N/m under one law, and one that sticks under another."""
    kinds, names = message_class("controller_status_t"), law_names()
    count = 4000
    time_ns = np.arange(count) * 1_000_000
    force = 8 * np.clip(np.sin(np.pi * (np.arange(count) % 2000 - 500) / 1000), 0, None)
    force[np.arange(count) % 2000 > 1500] = 0
    laws = [names.index("cartesian_impedance"), names.index("admittance")]
    law = np.where(np.arange(count) < 2000, *laws)
    status = records("controller_status_t", count, time_ns=time_ns, mode=kinds.MODE_ACTIVE)
    status["law"], status["quat_BT"][:, 0], status["quat_BD"][:, 0] = law, 1, 1
    status["K_x"][:] = np.diag([400.0] * 3 + [10] * 3)
    truth = records("sim_truth_t", count, time_ns=time_ns, num_joints=7)
    truth["F_push"][:, 1] = force
    truth["p_BT"][:, 1] = 0.2 + force / 400 * np.where(np.arange(count) < 2000, 1.0, 0.5)
    path = write_log(tmp_path / "log", {"CONTROLLER_STATUS": status, "SIM_TRUTH": truth})
    (chart,) = compliance_charts(Log(path))
    assert list(chart.series) == ["cartesian_impedance, y", "admittance, y", "400 N/m"]
    assert chart.x == "displacement of the tip (mm)" and chart.unit == "N"
    for name, stiffness in (("cartesian_impedance, y", 400), ("admittance, y", 800)):
        own = np.isfinite(chart.series[name])
        x_m, F = chart.t_s[own] * 1e-3, chart.series[name][own]
        assert F.max() == pytest.approx(8.0, rel=0.01)
        np.testing.assert_allclose(F, stiffness * x_m, atol=0.05)
    assert chart.dashed == {"400 N/m"}
    (ax,) = png.figure("x", Drawing("run", {"x": [chart]})).axes
    assert ax.get_xlabel() == "displacement of the tip (mm)"
