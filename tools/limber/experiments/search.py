"""Limits found by trying: where does a system stop being stable?"""

import math
from collections.abc import Callable

from limber.errors import RunError


def limit(holds: Callable[[float], bool], low: float, high: float, relative: float = 1e-6) -> float:
    """Where `holds`, true at `low` and false at `high`, changes; both positive, by bisection."""
    if not holds(low) or holds(high):
        raise RunError(f"no limit between {low:g} and {high:g}")
    while abs(high / low - 1.0) > relative:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return math.sqrt(low * high)
