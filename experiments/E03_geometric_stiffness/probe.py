"""An arm that carries a load with the joint law of Eq. 4, and what the tip then feels like."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from limber.experiments.context import Context
from limber.experiments.truth import motion, status
from limber.logs import Log

PROBE_N = 0.5
LOADED_AT, FIRST_AT = 1.2, 4.0  # s; the load, the first probe


@dataclass(frozen=True)
class Case:
    """A posture, rad, and the force of the world on the tip, N, that it is held under."""

    robot: str
    q: np.ndarray
    force: np.ndarray
    gains: dict[str, Any]
    axes: int  # of the tip that are probed, from x on
    settles_s: float  # how long a probe lasts

    def stiffness(self, context: Context, terms: str, name: str) -> np.ndarray:
        """N/m: inverse of how far the tip goes for ±0.5 N on top of the load."""
        log = context.lab(self.scenario(terms), name)
        moved = []
        for axis in range(self.axes):
            more, less = (self.tip(log, 2 * axis + i) for i in (0, 1))
            moved.append((more - less)[: self.axes] / (2 * PROBE_N))
        return np.linalg.inv(np.column_stack(moved))

    def scenario(self, terms: str) -> dict[str, Any]:
        end = self.starts_at(2 * self.axes) + 0.1
        load = {"force_N": self.force.tolist(), "ramp_s": 1.0, "for_s": end}
        held = {"joints_rad": self.q.tolist(), "force_N": (-self.force).tolist(), "duration_s": 1.0}
        probes = [
            {"force_N": (sign * axis).tolist(), "ramp_s": 0.3, "for_s": self.settles_s, "id": 2}
            for axis in PROBE_N * np.eye(3)[: self.axes]
            for sign in (1, -1)
        ]
        return {
            "robot": self.robot,
            "duration_s": end,
            "integrator": "reference",
            "start_q": self.q.tolist(),
            "timeline": [
                {"at_s": 0.3, "mode": "hold"},
                {"at_s": 0.8, "mode": "active"},
                {"at_s": 1.0, "gains": {"law": "eq4", "stiffness_terms": terms, **self.gains}},
                {"at_s": LOADED_AT, "goal": held},
                {"at_s": LOADED_AT, "push": load},
                *({"at_s": self.starts_at(i), "push": p} for i, p in enumerate(probes)),
            ],
        }

    def starts_at(self, probe: int) -> float:
        return FIRST_AT + self.settles_s * probe

    def tip(self, log: Log, probe: int) -> np.ndarray:
        """Where it rests before the probe goes again."""
        end = self.starts_at(probe + 1) - 0.3
        status(log, self.starts_at(probe), end)
        return motion(log, end - 0.02, end)["p_BT"].mean(axis=0)
