"""Charts fed batch by batch."""

import numpy as np
from made_logs import records

from limber import messages
from limber.monitor.charts import ChartPanel, Keeper
from limber.monitor.feed import Batch

MS = 10**6
WINDOWS = (10.0, 60.0)


def batches(count: int, size: int, start: int = 0, **fields):
    for first in range(start, start + count, size):
        rows = records("joint_state_t", size, num_joints=2, period_ns=MS, **fields)
        rows["time_ns"] = (first + np.arange(size)) * MS
        rows["q"][:, 0] = np.arange(first, first + size)
        driver = records("driver_status_t", 1, time_ns=first * MS, num_buses=1)
        yield Batch(
            {
                "JOINT_STATE": rows.astype(messages.native_dtype_of("joint_state_t")),
                "DRIVER_STATUS": driver.astype(messages.native_dtype_of("driver_status_t")),
            }
        )


def test_the_curves_are_those_of_the_messages():
    keeper = Keeper(["a", "b"], WINDOWS)
    for batch in batches(3000, 30):
        keeper.add(batch)
    position = keeper.kept["joints"]["joint position"]
    assert list(position.chart.series) == ["a", "b"]
    _, curves = position.bins[10.0].curves()
    assert (curves[0].min(), curves[0].max()) == (0, 2999)
    step = keeper.kept["timing"]["time from state to state"]
    _, curves = step.bins[10.0].curves()
    assert np.allclose(curves[0][2:], 1.0), "no false step where two batches meet"


def test_another_session_begins_anew():
    keeper = Keeper([], WINDOWS)
    for batch in (*batches(2000, 100, start=50_000), *batches(2000, 100)):
        keeper.add(batch)
    _, curves = keeper.kept["joints"]["joint position"].bins[10.0].curves()
    assert curves[0].max() == 1999


def test_a_jump_in_a_log_begins_anew():
    keeper = Keeper([], WINDOWS)
    for batch in batches(2000, 100, start=5000):
        keeper.add(batch)
    (jumped,) = batches(100, 100)
    jumped.restart = True
    keeper.add(jumped)
    _, curves = keeper.kept["joints"]["joint position"].bins[10.0].curves()
    assert curves[0].max() == 99


def test_the_panel_draws_what_is_chosen(served):
    keeper = Keeper(["a", "b"], WINDOWS)
    panel = ChartPanel(served.gui, keeper, WINDOWS)
    panel.draw()
    for batch in batches(2000, 100):
        keeper.add(batch)
    panel.draw()
    drawn = panel.handles["joint position"]
    assert drawn.data[0].min() >= -10.0 and drawn.data[0].max() <= 0.0
    assert drawn.data[1].max() == 1999
    assert all(len(column) == len(drawn.data[0]) for column in drawn.data)
    panel.topic.value = "timing"
    panel.draw()
    assert "joint position" not in panel.handles
    assert "time from state to state" in panel.handles


def test_drives_that_fall_silent_leave_no_gap():
    keeper = Keeper(["a", "b"], WINDOWS)
    for number, batch in enumerate(batches(2000, 100)):
        flags = batch.arrays["JOINT_STATE"]["joint_flags"]
        flags[:, :2] = 1  # JOINT_FRESH
        if number >= 10:
            flags[:99, 0] = 0
        keeper.add(batch)
    t, _ = keeper.kept["joints"]["joint position"].bins[10.0].curves()
    assert len(t) == 2 * 2.0 / (10.0 / 200), "every bin of the two seconds has its points"


def test_the_tail_counts_every_cycle_since_the_beginning():
    """One state in a hundred comes 500 us late; the controller takes 5 us, once 80."""
    keeper = Keeper([], WINDOWS)
    assert keeper.of("timing") == []
    for batch in batches(2000, 100):
        state = batch.arrays["JOINT_STATE"]
        state["time_ns"][50:] += 500_000
        status = records("controller_status_t", 20, cycle_ns=5_000, num_joints=2)
        status["time_ns"] = state["time_ns"][::5]
        status["cycle_ns"][7] = 80_000
        kind = messages.native_dtype_of("controller_status_t")
        batch.arrays["CONTROLLER_STATUS"] = status.astype(kind)
        keeper.add(batch)
    tail = keeper.of("timing")[-1]
    x, (later, own) = tail.curves(10.0)
    late = (x > 1) & (x < 499)
    assert np.allclose(later[late], 20 / 1999)
    assert np.isnan(later[x > 501]).all()
    assert np.allclose(own[x < 4.9], 1.0)
    assert np.allclose(own[(x > 5.1) & (x < 79)], 1 / 20)
    assert np.isnan(own[x > 81]).all()


def moving(keeper: Keeper, seconds: int = 2) -> None:
    for batch in batches(1000 * seconds, 100):
        batch.arrays["JOINT_STATE"]["tau"][:, 0] = batch.arrays["JOINT_STATE"]["q"][:, 0]
        keeper.add(batch)


def test_rest_is_drawn_as_rest(served):
    """uPlot draws zeros up to 100; an axis reaches at least so far about zero."""
    keeper = Keeper(["a", "b"], WINDOWS)
    panel = ChartPanel(served.gui, keeper, WINDOWS)
    moving(keeper)
    panel.draw()
    torque = panel.handles["torque the drives report"].scales["y"]["range"]
    assert (torque["min"]["soft"], torque["max"]["soft"]) == (-0.5, 0.5)
    assert torque["min"]["mode"] == torque["max"]["mode"] == 1
    position = panel.handles["joint position"].scales["y"]["range"]
    assert position["max"]["mode"] == 3, "only where all of it is zero"


def test_zero_is_a_line_where_a_chart_is_about_zero(served):
    keeper = Keeper(["a", "b"], WINDOWS)
    panel = ChartPanel(served.gui, keeper, WINDOWS)
    moving(keeper)
    panel.draw()
    torque = panel.handles["torque the drives report"]
    assert torque.series[-1]["label"] == "zero" and not torque.data[-1].any()
    assert len(torque.data) == len(torque.series) == 4
    assert len(panel.handles["joint position"].data) == 3


def test_charts_in_which_nothing_changes_are_words(served):
    keeper = Keeper(["a", "b"], WINDOWS)
    panel = ChartPanel(served.gui, keeper, WINDOWS)
    moving(keeper)
    panel.draw()
    assert set(panel.handles) == {"joint position", "torque the drives report"}
    assert "joint velocity 0 rad/s" in panel._nothing.content and panel._nothing.visible
    for batch in batches(1000, 100, start=2000):
        batch.arrays["JOINT_STATE"]["v"][:, 1] = 0.3
        keeper.add(batch)
    panel.draw()
    assert "joint velocity" in panel.handles, "it comes when it moves"
