"""Limits found by trying: where does a system stop being stable?"""

import math
from collections.abc import Callable, Sequence

import numpy as np

from limber.errors import RunError


def limit(holds: Callable[[float], bool], low: float, high: float, relative: float = 1e-6) -> float:
    """Where `holds`, true at `low` and false at `high`, changes; both positive, by bisection."""
    if not holds(low) or holds(high):
        raise RunError(f"no limit between {low:g} and {high:g}")
    while abs(high / low - 1.0) > relative:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return math.sqrt(low * high)


def limit_by_combs(
    hold: Callable[[np.ndarray], Sequence[bool]], low: float, high: float, count: int
) -> float:
    """The same where trying `count` values at once is cheap: a comb, then three finer ones."""
    for _ in range(4):
        tried = np.linspace(low, high, count)
        last = list(hold(tried)).index(False) - 1
        low, high = tried[last], tried[last + 1]
    return (low + high) / 2


def order(x: np.ndarray, y: Sequence[float]) -> float:
    """The exponent p of y ~ xᵖ."""
    return float(np.polyfit(np.log(x), np.log(y), 1)[0])
