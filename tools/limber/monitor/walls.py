"""The wall of a scenario at a time: timelines are played by controller and simulator, not sent."""

from dataclasses import dataclass

import numpy as np

from limber.model.scenario import Scenario


@dataclass(frozen=True)
class WallChange:
    """`wall`: point, m, and normal towards free space, base axes; None: it is taken away."""

    at_s: float
    wall: tuple[np.ndarray, np.ndarray] | None


def wall_changes(scenario: Scenario) -> list[WallChange]:
    """In order of time."""
    entries = [entry for entry in scenario.timeline if "wall" in entry]
    there = {wall.at_s: (wall.point, wall.normal) for wall in scenario.walls}
    return [
        WallChange(entry["at_s"], there[entry["at_s"]] if entry["wall"] else None)
        for entry in entries
    ]


def wall_at(changes: list[WallChange], time_s: float) -> tuple[np.ndarray, np.ndarray] | None:
    past = [change.wall for change in changes if change.at_s <= time_s]
    return past[-1] if past else None
