"""The page's memory, for an hour of messages at a speed that no arm has."""

import gc
import os
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from many_viewers import viewers
from rich.console import Console

from limber import messages
from limber.model.robot import load_robot
from limber.monitor import charts, page
from limber.monitor.feed import Batch
from limber.monitor.guard import Guard
from limber.monitor.laws import list_laws
from limber.monitor.page import Page
from limber.monitor.requests import Outcome
from limber.paths import robots_root

HOUR_S, RATE_HZ, STATUS_HZ = 3600, 200, 100
GROWTH_MB = 8  # the messages themselves are 1,000 MB


def rss_mb() -> float:
    gc.collect()
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


class Hour:
    """A second of an arm that moves, again and again, each second later than the one before."""

    def __init__(self) -> None:
        self.newest: dict[str, np.void] = {}
        self.second = 0
        self._rows = {
            "JOINT_STATE": self._make("joint_state_t", RATE_HZ),
            "CONTROLLER_STATUS": self._make("controller_status_t", STATUS_HZ),
            "SIM_TRUTH": self._make("sim_truth_t", STATUS_HZ),
        }
        state = self._rows["JOINT_STATE"]
        state["period_ns"] = 1_000_000
        for i in range(7):
            wave = np.sin(2 * np.pi * np.arange(RATE_HZ) / RATE_HZ + i)
            state["q"][:, i], state["v"][:, i], state["tau"][:, i] = wave, wave, wave
        status = self._rows["CONTROLLER_STATUS"]
        status["mode"], status["quat_BT"][:, 0], status["quat_BD"][:, 0] = 4, 1, 1
        status["p_BT"][:, 0] = 0.1 * np.sin(2 * np.pi * np.arange(STATUS_HZ) / STATUS_HZ)
        status["limits"][3] = 511

    @staticmethod
    def _make(kind: str, count: int) -> np.ndarray:
        rows = np.zeros(count, messages.native_dtype_of(kind))
        rows["num_joints"] = 7
        return rows

    def take(self) -> Batch:
        self.second += 1
        arrays = {}
        for channel, rows in self._rows.items():
            own = rows.copy()
            own["time_ns"] = round(self.second * 1e9) + np.arange(len(own)) * (10**9 // len(own))
            arrays[channel], self.newest[channel] = own, own[-1]
        return Batch(arrays)

    def age_s(self, _channel: str) -> float:
        return 0.0

    def troubles(self) -> list[str]:
        return []


def test_an_hour_of_messages_leaves_nothing_behind(served, monkeypatch):
    feed = Hour()
    clock = SimpleNamespace(monotonic=lambda: 1000.0 + feed.second, strftime=time.strftime)
    monkeypatch.setattr(page, "time", clock)
    monkeypatch.setattr(charts, "time", clock)
    robot = load_robot("openarm")
    guard = Guard(Console(quiet=True))
    shown = Page(served, robot, list_laws(robots_root() / "openarm"), feed, [], guard)
    shown.add_charts()
    topics = list(charts.TOPICS)
    with viewers(served.get_port(), 2) as looking:
        while len(served.get_clients()) < 2:
            time.sleep(0.02)
        quarter = 0.0
        while feed.second < HOUR_S:
            shown.draw()
            if feed.second % 7 == 0:
                shown.tell([Outcome("gains", f"refused at {feed.second}")])
            if feed.second % 60 == 0:
                shown.charts.topic.value = topics[feed.second // 60 % len(topics)]
            if feed.second == HOUR_S // 4:
                time.sleep(0.5)  # for what is on its way to the viewers
                quarter = rss_mb()
        time.sleep(0.5)
        assert min(looking.read) > 100, "the viewers see it"
    assert guard.faults == []
    assert rss_mb() - quarter < GROWTH_MB
