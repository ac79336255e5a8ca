"""Charts of the last seconds: those of `limber plot`, fed as messages come."""

import time
from dataclasses import dataclass, replace
from html import escape

import numpy as np
import viser
from viser import uplot

from limber.monitor.bins import Bins
from limber.monitor.feed import Batch
from limber.monitor.tail import EDGES_US, Tail
from limber.plot.chart import Chart
from limber.plot.charts import TOPICS as CHARTS

BINS = 200
HISTORY_S = 60.0
PADDING, OTHER_PADDING = (10, 12, 0, 0), (10, 12, 0, 1)  # another one makes a chart again
MADE_AGAIN_S = (1.0, 4.0, 10.0)  # a browser without a graphics card is slow
TOPICS = {
    "joints": "joint",
    "tip": "cartesian",
    "torque": "torque",
    "springs": "spring",
    "timing": "timing",
    "buses": "bus",
}
# Eight colours that stay apart for colour-blind readers (Okabe and Ito, 2008), without the yellow
COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#444444", "#8B4513")


BELOW = "font-size:0.8em;line-height:1.3;opacity:0.8;margin:2px 12px"
REST = 0.05  # reach of an axis on which all is zero
ZERO = uplot.Series(label="zero", stroke="#777777", width=1, points=uplot.Series_Points(show=False))


@dataclass
class Kept:
    """One chart's history: bins of the full history and of each shorter window."""

    chart: Chart  # without values: title, unit, names
    bins: dict[float, Bins]
    newest_s: float = -np.inf

    def curves(self, window_s: float) -> tuple[np.ndarray, np.ndarray]:
        """With a line along zero behind the series, where the chart is about zero."""
        t, values = self.bins[window_s].curves()
        return (t, np.vstack([values, np.zeros(len(t))])) if self.chart.least else (t, values)

    def constant(self) -> str:
        """The values in words if none has changed in the whole history, else empty."""
        _, values = self.bins[max(self.bins)].curves()
        series = dict(zip(self.chart.series, values, strict=True))
        return replace(self.chart, series=series).constant()


class Keeper:
    """The history of all charts, for each of the windows."""

    def __init__(self, joint_names: list[str], windows_s: tuple[float, ...]) -> None:
        self._names, self._windows = joint_names, windows_s
        self._begin()

    def _begin(self) -> None:
        self.kept: dict[str, dict[str, Kept]] = {topic: {} for topic in TOPICS}
        self._tail: Tail | None = None  # none in lock step, or before it is known
        self._tails: dict[str, np.ndarray] = {}

    def add(self, batch: Batch) -> None:
        if batch.restart:
            self._begin()
        joined = self._with_tails(batch)
        for topic, what in TOPICS.items():
            if what == "timing" and not len(joined.read("DRIVER_STATUS")):
                continue  # it tells whether there is a clock
            charts = CHARTS[what](joined, self._names)
            if what == "timing" and charts:
                self._tail = self._tail or Tail()
                self._tail.add(joined, batch)
            for chart in charts:
                if chart.over_time and len(chart.t_s) > 1 and chart.series:
                    self._add(self.kept[topic], chart)

    def of(self, topic: str) -> list[Kept | Tail]:
        """All charts of a topic that there is something of."""
        found: list[Kept | Tail] = list(self.kept[topic].values())
        if TOPICS[topic] == "timing" and self._tail is not None:
            found.append(self._tail)
        return found

    def _with_tails(self, batch: Batch) -> Batch:
        """Each channel with the message before, so that differences have something to begin at."""
        joined = Batch(self._tails)
        joined.add(batch)
        self._tails = {channel: rows[-1:] for channel, rows in joined.arrays.items()}
        return joined

    def _add(self, kept: dict[str, Kept], chart: Chart) -> None:
        one = kept.get(chart.title)
        if one is None or list(one.chart.series) != list(chart.series):
            head = replace(chart, t_s=chart.t_s[:0], series=dict(chart.series))
            bins = {w: Bins(w / BINS, BINS, len(chart.series)) for w in self._windows}
            one = kept[chart.title] = Kept(head, bins)
        if chart.t_s[-1] < one.newest_s - 1.0:  # another session of the driver: time begins again
            del kept[chart.title]
            return
        new = chart.t_s > one.newest_s
        if new.any():
            values = np.array(list(chart.series.values()))[:, new]
            for kept_bins in one.bins.values():
                kept_bins.add(chart.t_s[new], values)
            one.newest_s = float(chart.t_s[-1])


class ChartPanel:
    """Draws the charts of one topic; what is not shown costs nothing but its history."""

    def __init__(self, gui: viser.GuiApi, keeper: Keeper, windows_s: tuple[float, ...]) -> None:
        self._gui, self._keeper = gui, keeper
        self.topic = gui.add_dropdown("show", tuple(TOPICS), initial_value="joints")
        self._joint = gui.add_dropdown("of", ("-",), visible=False)
        labels = tuple(f"{window:g} s" for window in windows_s)
        self._window = gui.add_dropdown("last", labels, initial_value=labels[0])
        self._windows = dict(zip(labels, windows_s, strict=True))
        self._place = gui.add_folder(None)
        self._nothing, self._words = gui.add_html("no messages yet"), ""
        self.handles: dict[str, viser.GuiUplotHandle] = {}
        self._drawn: tuple = ()
        self._make_again_s: list[float] = []

    def make_again(self) -> None:
        """In a moment. uPlot draws no time axis into a chart that was made before its place on the
        page had a width, as in a browser that has just connected.
        """
        self._make_again_s = [time.monotonic() + wait_s for wait_s in MADE_AGAIN_S]

    def draw(self) -> None:
        topic, window_s = self.topic.value, self._windows[self._window.value]
        kept = self._keeper.of(topic)
        still = {id(one): one.constant() for one in kept if isinstance(one, Kept)}
        moving = [one for one in kept if not still.get(id(one))]
        shown = self._chosen(moving or kept, topic)
        self._tell([words for words in still.values() if words and moving], topic, bool(kept))
        key = (topic, window_s, *((one.chart.title, *one.chart.series) for one in shown))
        if key != self._drawn:
            self._rebuild(shown, window_s)
            self._drawn = key
            self.make_again()
        for one in shown:
            t, values = one.curves(window_s)
            if len(t):
                self.handles[one.chart.title].data = (t, *values)
        if self._make_again_s and self._make_again_s[0] < time.monotonic():
            self._make_again_s.pop(0)
            for handle in self.handles.values():
                handle.padding = OTHER_PADDING if handle.padding == PADDING else PADDING

    def _tell(self, still: list[str], topic: str, any_kept: bool) -> None:
        words = "" if any_kept else f"nothing to show of: {topic}"
        if still:
            words = f"Constant for {HISTORY_S:g} s, not drawn: {'; '.join(still)}"
        if words != self._words:
            self._words = words
            self._nothing.content = f'<div style="{BELOW}">{escape(words)}</div>'
            self._nothing.visible = bool(words)

    def _chosen(self, kept: list[Kept | Tail], topic: str) -> list[Kept | Tail]:
        """Of the torques, those of one joint and whatever belongs to none."""
        names = [one.chart.title.removeprefix("torque of ") for one in kept]
        joints = [n for n, one in zip(names, kept, strict=True) if n != one.chart.title]
        self._joint.visible = topic == "torque" and bool(joints)
        if not self._joint.visible:
            return kept
        if self._joint.options != tuple(joints):
            self._joint.options = tuple(joints)
        return [
            one
            for n, one in zip(names, kept, strict=True)
            if n == one.chart.title or n == self._joint.value
        ]

    def _rebuild(self, shown: list[Kept | Tail], window_s: float) -> None:
        for handle in self.handles.values():
            handle.remove()
        with self._place:
            self.handles = {one.chart.title: self._chart(one, window_s) for one in shown}

    def _chart(self, one: Kept | Tail, window_s: float) -> viser.GuiUplotHandle:
        chart = one.chart
        series = [uplot.Series(label="s" if chart.over_time else chart.x)]
        for name, number in zip(chart.series, chart.color_numbers(), strict=True):
            line = uplot.Series(
                label=name,
                stroke=COLORS[number % len(COLORS)],
                width=1.2,
                points=uplot.Series_Points(show=False),
            )
            if name in chart.dashed:
                line["dash"] = (6, 4)
            series.append(line)
        t, values = one.curves(window_s)
        if len(values) > len(chart.series):
            series.append(ZERO)
        return self._gui.add_uplot(
            (t, *values),
            tuple(series),
            title=f"{chart.title} / {chart.unit}",
            scales=_scales(chart, window_s),
            axes=(uplot.Axis(size=34), uplot.Axis(size=56)),
            padding=PADDING,
            height=170,
            legend=uplot.Legend(show=True, live=False),
        )


def _scales(chart: Chart, window_s: float) -> dict[str, uplot.Scale]:
    if chart.over_time:
        x = uplot.Scale(time=False, auto=False, range=(-window_s, 0.0))
        return {"x": x, "y": uplot.Scale(range=_least(chart))}
    x = uplot.Scale(
        time=False, auto=False, distr=3, range=(float(EDGES_US[0]), float(EDGES_US[-1]))
    )
    return {"x": x, "y": uplot.Scale(distr=3, range=(1e-6, 1.0))}


def _least(chart: Chart) -> dict[str, dict[str, float]]:
    """uPlot's range of an axis: by the data, but never less than the least about zero (mode 1); of
    others, only where all is zero (mode 3), which uPlot would draw up to 100.
    """
    soft, mode = (chart.least, 1) if chart.least else (REST, 3)
    low = {"pad": 0.0, "hard": 0.0} if chart.zero else {"pad": 0.1, "soft": -soft, "mode": mode}
    return {"min": low, "max": {"pad": 0.1, "soft": soft, "mode": mode}}
