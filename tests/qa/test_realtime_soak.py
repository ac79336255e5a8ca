"""The judgement of a soak in real time: which stops have a cause."""

import json
import os
import time

import numpy as np
import pytest

from limber_qa.machine_pauses import Pause, Watchers, stood_still_s
from limber_qa.realtime_soak import BACK_S, ENOUGH_S, Stop
from limber_qa.realtime_soak_picture import draw

PAUSES = [Pause(0, 1.0, 0.030), Pause(0, 2.0, 0.010), Pause(1, 2.1, 0.025)]


@pytest.mark.parametrize(
    ("begin_s", "end_s", "expected_s"),
    [
        (1.5, 2.5, 0.025),  # of two processors, the one that stood still for longer
        (0.5, 2.5, 0.040),  # two pauses of one processor
        (1.02, 2.0, 0.010),  # only the part within
        (3.0, 4.0, 0.0),
    ],
)
def test_pauses_count_by_processor_and_within_the_time(begin_s, end_s, expected_s):
    assert stood_still_s(PAUSES, begin_s, end_s) == pytest.approx(expected_s)


def test_no_pauses_are_no_cause():
    assert stood_still_s([], 0.0, 1.0) == 0.0


def test_a_stop_needs_a_cause_and_a_way_back():
    good = Stop(60.0, "driver.OVERRUN", machine_stood_still_s=2 * ENOUGH_S, back_after_s=0.2)
    assert good.violation() == ""
    calm = Stop(60.0, "driver.CONTROLLER_LOST", ENOUGH_S / 2, 0.2)
    assert "after 60.0 s: driver.CONTROLLER_LOST: the machine stood still for 25.0 ms only" in (
        calm.violation()
    )
    for back_s in (None, BACK_S + 1):
        lost = Stop(60.0, "driver.OVERRUN", 2 * ENOUGH_S, back_s)
        assert "did not come back within 10 s" in lost.violation()


def test_there_is_a_watcher_on_each_processor(tmp_path):
    with Watchers(tmp_path) as watchers:
        time.sleep(1.0)
        names = {path.name for path in tmp_path.iterdir()}
        pauses = watchers.pauses()
    assert names == {f"pauses-{cpu}.jsonl" for cpu in os.sched_getaffinity(0)}
    assert all(pause.length_s > 0.0 for pause in pauses)


def test_what_watchers_wrote_is_read_in_order(tmp_path):
    watchers = Watchers(tmp_path)
    for cpu in os.sched_getaffinity(0):
        lines = [json.dumps([start, 0.002]) for start in (1.0 + cpu, 5.0 - cpu)]
        (tmp_path / f"pauses-{cpu}.jsonl").write_text("\n".join(lines) + "\n")
    starts = [pause.start_s for pause in watchers.pauses()]
    assert starts == sorted(starts)
    assert len(starts) == 2 * len(os.sched_getaffinity(0))


def test_the_picture_is_drawn_with_and_without_stops(tmp_path):
    rows = np.array([[100.0 + k, 0.0, 60.0, 500.0, 2000.0] for k in range(5)])
    draw(rows, [], [], 100.0, tmp_path / "calm.png")
    draw(rows, [Stop(2.0, "driver.OVERRUN")], PAUSES, 100.0, tmp_path / "stop.png")
    assert {path.name for path in tmp_path.iterdir()} == {"calm.png", "stop.png"}
