"""An arm that carries a load with the joint law of Eq. 4."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from limber.experiments.context import Context
from limber.experiments.probing import Probing

LOADED_AT, FIRST_AT = 1.2, 4.0  # s; the load, the first probe


@dataclass(frozen=True)
class Loaded:
    """A posture, rad, and the force of the world on the tip, N, that it is held under."""

    robot: str
    q: np.ndarray
    force: np.ndarray
    gains: dict[str, Any]
    axes: int  # of the tip that are probed
    settles_s: float  # how long a probe lasts

    def stiffness(self, context: Context, terms: str, name: str) -> np.ndarray:
        """What the tip feels like, N/m."""
        probing = Probing(FIRST_AT, self.settles_s, self.axes)
        return probing.stiffness(context.lab(self.scenario(terms, probing), name))

    def scenario(self, terms: str, probing: Probing) -> dict[str, Any]:
        end = probing.end + 0.1
        load = {"force_N": self.force.tolist(), "ramp_s": 1.0, "for_s": end}
        held = {"joints_rad": self.q.tolist(), "force_N": (-self.force).tolist(), "duration_s": 1.0}
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
                *probing.timeline(),
            ],
        }
