"""Series for a picture: no more points than it can show, and no spike lost."""

from dataclasses import dataclass, replace

import numpy as np

from limber.arrays import Flags, Floats
from limber.plot.chart import Chart

SEEN = 0.02  # of the whole range of a chart: what is wider is more than a thick line
BACK = 1.5  # times the width: a value that travels so far within a bin goes up and down
OFTEN = 0.03  # of the bins
MAX_POINTS = 60_000  # of a series
AVERAGED = 9  # bins, where a value swings: its period may beat with the bins


@dataclass(frozen=True)
class Binned:
    """Of each bin smallest, greatest, mean, and how far the value travels; `t_s`: the middle of the
    bins. NaN: no value.
    """

    t_s: Floats
    low: Floats
    high: Floats
    mean: Floats
    travel: Floats

    def swinging(self, span: float) -> Flags:
        """In which bins it goes up and down, such as with dither; `span`: of the whole chart."""
        width = self.high - self.low
        return (width > SEEN * span) & (self.travel > BACK * width)

    def steady(self, span: float) -> Floats:
        """The mean, over more than one bin where it swings."""
        where = self.swinging(span)
        if not where.any():
            return self.mean
        kernel = np.bartlett(AVERAGED + 2)[1:-1]
        known = np.isfinite(self.mean)
        total = np.convolve(np.where(known, self.mean, 0.0), kernel, "same")
        weight = np.convolve(known.astype(float), kernel, "same")
        near = np.convolve(where, np.ones(AVERAGED), "same") > 0
        return np.where(near & known, total / np.maximum(weight, 1e-9), self.mean)

    @property
    def outline(self) -> tuple[Floats, Floats]:
        """One line through smallest and greatest of each bin, which looks as all points would."""
        if self.low is self.high:
            return self.t_s, self.mean
        t = np.repeat(self.t_s, 2)
        return t, np.column_stack([self.low, self.high]).ravel()


def binned(t_s: Floats, values: Floats, bins: int) -> Binned:
    """As it is if it has no more than two points a bin."""
    count = len(t_s)
    values = np.asarray(values, float)
    if count <= 2 * bins:
        return Binned(t_s, values, values, values, np.zeros(count))
    starts = np.linspace(0, count, bins, endpoint=False).astype(int)
    finite = np.isfinite(values)
    low = np.minimum.reduceat(np.where(finite, values, np.inf), starts)
    high = np.maximum.reduceat(np.where(finite, values, -np.inf), starts)
    total = np.add.reduceat(np.where(finite, values, 0.0), starts)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = total / np.add.reduceat(finite, starts)
    low[~np.isfinite(mean)] = high[~np.isfinite(mean)] = np.nan
    ends = np.append(starts[1:], count) - 1
    steps = np.nan_to_num(np.abs(np.diff(values, append=values[-1:])))
    steps[ends] = 0.0  # to the next bin
    travel = np.add.reduceat(steps, starts)
    return Binned(0.5 * (t_s[starts] + t_s[ends]), low, high, mean, travel)


def swings(one: Binned, span: float) -> bool:
    """Its outline would be a block: it swings in many bins."""
    return bool(span > 0 and np.mean(one.swinging(span)) > OFTEN)


def span_of(chart: Chart) -> float:
    values = [v[np.isfinite(v)] for v in chart.series.values()]
    values = [v for v in values if len(v)]
    if not values:
        return 0.0
    return float(max(v.max() for v in values) - min(v.min() for v in values))


def thinned(chart: Chart, points: int = MAX_POINTS) -> Chart:
    """At most so many points a series; smallest and greatest of each bin stay."""
    count = len(chart.t_s)
    if count <= points:
        return chart
    bins = max(points // 2, 1)
    starts = np.linspace(0, count, bins, endpoint=False).astype(int)
    series = {name: binned(chart.t_s, v, bins).outline[1] for name, v in chart.series.items()}
    return replace(chart, t_s=np.repeat(chart.t_s[starts], 2), series=series)
