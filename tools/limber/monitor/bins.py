"""Time series for the screen: smallest and greatest value of each bin, so that no spike is lost."""

import numpy as np


class Bins:
    """A ring of `count` bins of `width_s` each; one row a series. Memory does not grow."""

    def __init__(self, width_s: float, count: int, series: int) -> None:
        self.width_s, self.count = width_s, count
        self._low = np.full((series, count), np.nan)
        self._high = np.full((series, count), np.nan)
        self._newest = -1  # number of the newest bin since time 0

    def add(self, t_s: np.ndarray, values: np.ndarray) -> None:
        """`values`: series x samples; samples that are not finite leave no mark. What is older
        than the ring is left out.
        """
        bins = np.floor(np.asarray(t_s, float) / self.width_s).astype(np.int64)
        if not len(bins):
            return
        self._advance(int(bins.max()))
        kept = bins > self._newest - self.count
        bins, values = bins[kept], np.asarray(values, float)[:, kept]
        starts = np.flatnonzero(np.diff(bins, prepend=bins[:1] - 1))
        places = bins[starts] % self.count
        finite = np.isfinite(values)
        low = np.minimum.reduceat(np.where(finite, values, np.inf), starts, axis=1)
        high = np.maximum.reduceat(np.where(finite, values, -np.inf), starts, axis=1)
        empty = low > high
        low[empty] = high[empty] = np.nan
        for column, place in enumerate(places):  # a bin may come twice if time is not ordered
            self._low[:, place] = np.fmin(self._low[:, place], low[:, column])
            self._high[:, place] = np.fmax(self._high[:, place], high[:, column])

    def _advance(self, newest: int) -> None:
        steps = min(newest - self._newest, self.count) if self._newest >= 0 else self.count
        if steps <= 0:
            return
        fresh = (newest - np.arange(steps)) % self.count
        self._low[:, fresh] = self._high[:, fresh] = np.nan
        self._newest = newest

    def curves(self) -> tuple[np.ndarray, np.ndarray]:
        """Time before the newest bin's end, s (two points a bin), and series x points; bins
        without any value are left out.
        """
        numbers = self._newest + 1 - self.count + np.arange(self.count)
        places = numbers % self.count
        low, high = self._low[:, places], self._high[:, places]
        filled = np.isfinite(low).any(axis=0)
        t = (numbers[filled] - self._newest - 1) * self.width_s
        t = np.column_stack([t, t + 0.5 * self.width_s]).ravel()
        values = np.stack([low[:, filled], high[:, filled]], axis=2)
        return t, values.reshape(len(values), -1)
