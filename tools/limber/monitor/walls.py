"""The wall of a scenario at a time: timelines are played by controller and simulator, not sent."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from limber.model.robot import read_yaml


@dataclass(frozen=True)
class WallChange:
    """`wall`: point, m, and normal towards free space, base axes; None: it is taken away."""

    at_s: float
    wall: tuple[np.ndarray, np.ndarray] | None


def wall_changes(scenario: Path) -> list[WallChange]:
    """In order of time. What is wrong in the file is the checker's to tell."""
    entries = [e for e in read_yaml(scenario).get("timeline") or [] if "wall" in e]
    found = [WallChange(float(entry["at_s"]), _wall(entry["wall"])) for entry in entries]
    return sorted(found, key=lambda change: change.at_s)


def wall_at(changes: list[WallChange], time_s: float) -> tuple[np.ndarray, np.ndarray] | None:
    past = [change.wall for change in changes if change.at_s <= time_s]
    return past[-1] if past else None


def _wall(content: Any) -> tuple[np.ndarray, np.ndarray] | None:
    if not isinstance(content, dict):
        return None
    return np.asarray(content["point_m"], float), np.asarray(content["normal"], float)
