"""How the tip goes from rest to rest under a push: how far beyond, and how long."""

import numpy as np

from limber.arrays import Records
from limber.log.reader import time_s
from limber.measure.pushes import BEFORE_S, MeasuredPush
from limber.model import rotations

SETTLED = 0.05  # of the displacement


def transient(truth: Records, measured: MeasuredPush) -> tuple[float, float] | None:
    """Along a push that SIM_TRUTH covers; None if nothing moved. Overshoot: beyond the displacement
    at rest, as a share of it, at least 0. Settling: from the end of the push's ramp until the tip
    stays within 5 % of it, s.
    """
    push, t = measured.push, time_s(truth)
    before = truth[(t >= push.at_s - BEFORE_S) & (t < push.at_s)]
    during = truth[(t >= push.at_s) & (t < measured.span[1])]
    if measured.moved == 0.0 or not len(during):
        return None
    start = rotations.mean(before["quat_BT"])
    moved = during["p_BT"] - before["p_BT"].mean(axis=0)
    turned = rotations.between(start, during["quat_BT"])
    share = np.hstack([moved, turned]) @ measured.direction / measured.moved
    away = np.flatnonzero(np.abs(share - 1.0) > SETTLED)
    settled_s = time_s(during)[away[-1]] - push.at_s - push.ramp_s if len(away) else 0.0
    return max(float(share.max()) - 1.0, 0.0), max(float(settled_s), 0.0)
