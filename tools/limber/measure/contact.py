"""A wall the arm touched: how fast, how hard, and whether the force fits the wall's stiffness."""

import numpy as np

from limber.log.reader import time_s
from limber.measure.results import Result, close_to
from limber.model.scenario import Scenario

STATIC_S = 0.3
APPROACH_S = 0.01


def contact_results(truth: np.ndarray, scenario: Scenario, tolerance: float) -> list[Result]:
    touching = truth["contact"] != 0
    if not scenario.walls or not len(truth):
        return []
    if not touching.any():
        return [Result("wall touched", False)]
    t = time_s(truth)
    wall = scenario.walls[0]
    force = truth["F_contact"][:, :3] @ wall.normal
    first = int(np.argmax(touching))
    approach = (t >= t[first] - APPROACH_S) & (t <= t[first])
    speed = -(truth["V_BT"][approach][:, :3] @ wall.normal).mean()
    results = [
        Result("speed at contact", float(speed), "m/s"),
        Result("peak contact force", float(force.max()), "N"),
    ]
    results[0].span = (t[first] - APPROACH_S, t[first])
    results[1].span = (t[first], t[int(force.argmax())])
    steady = _steadiest(t, touching, force)
    if steady is not None and np.ptp(force[steady]) < 0.05 * force[steady].mean() + 0.1:
        depth = -((truth["p_BT"][steady] - wall.point) @ wall.normal).mean()
        predicted = wall.stiffness_N_per_m * depth
        measured = force[steady].mean()
        note = f"wall's stiffness x {depth * 1e3:.3g} mm"
        allowed = tolerance * abs(predicted)
        static = close_to("static contact force", measured, "N", predicted, allowed, note)
        static.span = (t[steady][0], t[steady][-1])
        results.append(static)
    return results


def _steadiest(t: np.ndarray, touching: np.ndarray, force: np.ndarray) -> np.ndarray | None:
    """The STATIC_S of unbroken contact in which the force changes least."""
    best, least = None, np.inf
    for start in np.arange(t[touching][0], t[touching][-1] - STATIC_S, STATIC_S / 6):
        window = (t >= start) & (t < start + STATIC_S)
        if touching[window].all() and np.ptp(force[window]) < least:
            best, least = window, np.ptp(force[window])
    return best
