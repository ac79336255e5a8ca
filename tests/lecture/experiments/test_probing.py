"""The stiffness of a tip from its rests, on a log made up of a spring that is known."""

from pathlib import Path

import numpy as np
import pytest

from limber.errors import RunError
from limber_lecture.probing import Probing

PROBING = Probing(first_at=2.0, each_s=1.0, axes=2)
K = np.array([[300.0, -50.0], [-20.0, 120.0]])  # N/m, not symmetric on purpose
START = np.array([0.4, 0.3, 0.1])  # m


class SpringLog:
    """A massless tip at the end of the spring, under the forces of the timeline."""

    path = Path("made-up")

    def __init__(self, limits: int = 0) -> None:
        self.limits = limits

    def read(self, channel: str) -> np.ndarray:
        fields = [("time_ns", "i8"), ("p_BT", "f8", 3), ("mode", "i1"), ("limits", "i4")]
        times = np.arange(0, round(1000 * (PROBING.end + 0.1)))
        rows = np.zeros(len(times), [*fields, ("requests_refused", "i8")])
        rows["time_ns"], rows["mode"], rows["limits"] = times * 1_000_000, 4, self.limits
        rows["p_BT"] = START
        for entry in PROBING.timeline():
            force = np.array(entry["push"]["force_N"])
            pushed = (times >= 1000 * entry["at_s"]) & (times < 1000 * (entry["at_s"] + 1.0))
            rows["p_BT"][pushed, :2] += np.linalg.solve(K, force[:2])
        return rows


def test_stiffness_of_a_spring():
    assert PROBING.stiffness(SpringLog()) == pytest.approx(K, rel=1e-9)


def test_refuses_a_run_in_which_a_limit_acts():
    with pytest.raises(RunError, match="limits act: TORQUE"):
        PROBING.stiffness(SpringLog(limits=1))
