"""How seldom a cycle takes longer than a time: counted since the page began to listen."""

import numpy as np

from limber.monitor.feed import Batch
from limber.plot.chart import Chart
from limber.plot.charts import LATER, OWN_TIME, TAIL_TITLE, TAIL_X

EDGES_US = np.geomspace(1.0, 1e5, 101)


class Tail:
    """A chart whose counts grow; it costs the same however long the arm runs."""

    def __init__(self) -> None:
        self._counts = {name: np.zeros(len(EDGES_US) + 1, np.int64) for name in (LATER, OWN_TIME)}
        empty = {name: np.zeros(0) for name in self._counts}
        self.chart = Chart(TAIL_TITLE, "1", np.zeros(0), empty, x=TAIL_X, log=True)

    def add(self, joined: Batch, fresh: Batch) -> None:
        """`joined`: with the message before on each channel, `fresh`: without."""
        state = joined.read("JOINT_STATE")
        late_ns = np.diff(state["time_ns"]) - state["period_ns"][1:]
        same = np.diff(state["session"]) == 0
        self._count(LATER, late_ns[same] * 1e-3)
        self._count(OWN_TIME, fresh.read("CONTROLLER_STATUS")["cycle_ns"] * 1e-3)

    def _count(self, name: str, samples_us: np.ndarray) -> None:
        places = np.searchsorted(EDGES_US, samples_us, side="left")
        self._counts[name] += np.bincount(places, minlength=len(EDGES_US) + 1)

    def curves(self, _window_s: float) -> tuple[np.ndarray, np.ndarray]:
        """Times, us, and for each series the share of cycles that took longer; NaN for none."""
        shares = []
        for counts in self._counts.values():
            longer = counts.sum() - np.cumsum(counts)[:-1]
            shares.append(np.where(longer > 0, longer / max(counts.sum(), 1), np.nan))
        return EDGES_US, np.array(shares)
