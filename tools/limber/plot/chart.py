"""One chart: lines over arm time, or another x."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

ARM_TIME = "arm time (s)"


RESTART_S = 1.0


class Messages(Protocol):
    """A log, or what has arrived of a running arm."""

    def read(self, channel: str) -> np.ndarray:
        """Messages of a fixed-size channel as one structured array."""
        ...


def went_back(t_s: np.ndarray) -> np.ndarray:
    """From where on arm time has begun anew, since the driver was started again: by more than what
    messages of several senders are apart.
    """
    return np.logical_or.accumulate(np.maximum.accumulate(t_s) - t_s > RESTART_S)


@dataclass
class Chart:
    """Lines over `t_s`, arm time; every series has one value for each of its entries.

    `stacked`: these are drawn as areas on top of each other, negative values below zero; the others
    as lines. `x`: what `t_s` is if it is not arm time. `log`: logarithmic axes.
    `zero`: the y axis begins at zero. `least`: the y axis reaches at least so far on both sides of
    zero, so that rest looks like rest; 0: no such quantity. `loop`: a way through the plane of x
    and y, which may go back.
    """

    title: str
    unit: str
    t_s: np.ndarray
    series: dict[str, np.ndarray] = field(default_factory=dict)
    dashed: set[str] = field(default_factory=set)
    stacked: set[str] = field(default_factory=set)
    x: str = ARM_TIME
    log: bool = False
    zero: bool = False
    least: float = 0.0
    loop: bool = False

    @property
    def over_time(self) -> bool:
        return self.x == ARM_TIME

    def since(self, begin_s: float) -> "Chart":
        """From then on, until the driver starts again: then arm time begins anew."""
        if not self.over_time:
            return self
        kept = (self.t_s >= begin_s) & ~went_back(self.t_s)
        series = {name: values[kept] for name, values in self.series.items()}
        return replace(self, t_s=self.t_s[kept], series=series)

    def constant(self) -> str:
        """The values in words if none of them changes, else empty."""
        ends = []
        for values in self.series.values():
            finite = values[np.isfinite(values)]
            if len(finite) and finite.min() != finite.max():
                return ""
            ends += [f"{finite[0]:.4g}"] if len(finite) else []
        if not ends:
            return ""
        return f"{self.title} {' / '.join(ends if len(set(ends)) > 1 else ends[:1])} {self.unit}"

    def color_numbers(self) -> list[int]:
        """One for each series; "q desired" has the colour of the "q" before it."""
        numbers: list[int] = []
        before = None
        for name in self.series:
            paired = before is not None and name.startswith(f"{before} ")
            numbers.append(numbers[-1] if paired else max(numbers, default=-1) + 1)
            before = name
        return numbers

    def areas(self) -> Iterator[tuple[str, np.ndarray, np.ndarray]]:
        """Name, lower and upper edge of each stacked series; positive and negative values apart."""
        above, below = np.zeros(len(self.t_s)), np.zeros(len(self.t_s))
        for name, values in self.series.items():
            if name not in self.stacked:
                continue
            base = np.where(values >= 0, above, below)
            yield name, base, base + values
            above, below = above + np.maximum(values, 0), below + np.minimum(values, 0)
