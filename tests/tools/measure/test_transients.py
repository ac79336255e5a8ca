"""Overshoot and settling of made-up motions, against the closed form of two poles."""

import numpy as np
import pytest
from made_logs import records

from limber.measure.pushes import MeasuredPush
from limber.measure.transients import transient
from limber.model.scenario import Push

AT, LONG, MOVED, OMEGA = 2.0, 1.0, 0.02, 40.0


def truth(along: np.ndarray, t: np.ndarray, angular: bool) -> np.ndarray:
    made = records("sim_truth_t", len(t))
    made["time_ns"] = np.round(t * 1e9)
    made["quat_BT"][:, 0] = 1.0
    if angular:
        made["quat_BT"][:, 0] = np.cos(along / 2)
        made["quat_BT"][:, 2] = np.sin(along / 2)  # about y
    else:
        made["p_BT"] = [0.3, 0.0, 0.5]
        made["p_BT"][:, 1] += along
    return made


def pushed(angular: bool, moved: float = MOVED, ramp_s: float = 0.0) -> MeasuredPush:
    direction = np.zeros(6)
    direction[4 if angular else 1] = 1.0
    push = Push(AT, 5 * direction, ramp_s, LONG)
    return MeasuredPush(push, 5 * direction, moved * direction, direction, np.eye(6), 0, 0, 0)


def step(ratio: float, t: np.ndarray) -> np.ndarray:
    """Of x'' + 2 zeta w x' + w² x = w² from rest at AT."""
    s = np.maximum(t - AT, 0.0)
    damped = OMEGA * np.sqrt(1 - ratio**2)
    swing = np.cos(damped * s) + ratio * OMEGA / damped * np.sin(damped * s)
    return 1 - np.exp(-ratio * OMEGA * s) * swing


@pytest.mark.parametrize("angular", [False, True])
@pytest.mark.parametrize("ratio", [0.2, 0.5, 0.7])
def test_two_poles(ratio, angular):
    t = np.arange(1.5, 3.2, 1e-3)
    over, settling_s = transient(truth(MOVED * step(ratio, t), t, angular), pushed(angular))
    assert over == pytest.approx(np.exp(-np.pi * ratio / np.sqrt(1 - ratio**2)), rel=0.01)
    outside = t[np.abs(step(ratio, t) - 1) > 0.05]
    assert settling_s == pytest.approx(outside[-1] - AT, abs=1.5e-3)


def test_a_creeping_tip_has_no_overshoot_and_one_that_stands_has_no_way():
    t = np.arange(1.5, 3.2, 1e-3)
    creeping = MOVED * (1 - np.exp(-np.maximum(t - AT, 0) / 0.1))
    for ramp_s in (0.0, 0.1):
        over, settling_s = transient(truth(creeping, t, False), pushed(False, ramp_s=ramp_s))
        assert over == 0.0
        assert settling_s == pytest.approx(0.1 * np.log(20) - ramp_s, abs=1.5e-3)
    assert transient(truth(0 * t, t, False), pushed(False, moved=0.0)) is None
