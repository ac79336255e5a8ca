"""The stiffness that a hand feels: the tip is pushed a little to and fro along each axis."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from limber.log.reader import Log
from limber_lecture.truth import motion, status


@dataclass(frozen=True)
class Probing:
    """Small forces in turn, along x and -x, y and -y and so on, each until the arm rests."""

    first_at: float  # s
    each_s: float
    axes: int  # of the tip that are probed, from x on
    force: float = 0.5  # N
    ramp_s: float = 0.3

    @property
    def end(self) -> float:
        return self.first_at + self.each_s * 2 * self.axes

    def timeline(self) -> list[dict[str, Any]]:
        """Entries of a scenario. They replace any other push with the id 2."""
        forces = [sign * self.force * axis for axis in np.eye(3)[: self.axes] for sign in (1, -1)]
        shape = {"ramp_s": self.ramp_s, "for_s": self.each_s, "id": 2}
        return [
            {"at_s": self.first_at + self.each_s * i, "push": {"force_N": f.tolist(), **shape}}
            for i, f in enumerate(forces)
        ]

    def stiffness(self, log: Log) -> np.ndarray:
        """N/m, the inverse of what the tip moves by a force."""
        rests = [self._rest(log, i) for i in range(2 * self.axes)]
        moved = [
            (more - less) / (2 * self.force)
            for more, less in zip(rests[::2], rests[1::2], strict=True)
        ]
        return np.linalg.inv(np.column_stack(moved)[: self.axes])

    def _rest(self, log: Log, probe: int) -> np.ndarray:
        """Where the tip is before the force goes again."""
        start = self.first_at + self.each_s * probe
        end = start + self.each_s - self.ramp_s
        status(log, start, end)
        place: np.ndarray = motion(log, end - 0.02, end)["p_BT"].mean(axis=0)
        return place
