"""Each joint is pushed and let go, led along a slow path, and loaded with its weight.

Each on its equations with exact sensors (ideal) and behind a CiA 402 drive (bus).
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from limber.experiments import testbench as bench
from limber.experiments.context import Context
from limber.experiments.elastic import run

from .joints import WEIGHT_NM, D, Joint, K

PUSH_NM, RAMP_S, HOLD_S, FREE_S = 20.0, 1.0, 0.5, 1.5
STEPS = 100  # of the ramp
MOVE_RAD, MOVE_S = 1.0, 3.0
REST_S = 4.0
START_S = 2.0


@dataclass(frozen=True)
class Seen:
    """`t` since the joint was let go, `q` less where it was before the push, rad."""

    stiffness: float  # N m/rad
    overshoot: float  # share of the way back
    lag: float  # rad
    sag: float  # rad
    t: np.ndarray
    q: np.ndarray


def pushed(t: np.ndarray | float) -> np.ndarray | float:
    """Torque on the link, t since the push began: up a ramp, held, let go at once."""
    held = np.clip(t / RAMP_S, 0, 1) * PUSH_NM
    return np.where(t < RAMP_S + HOLD_S, held, 0.0)


def pushes() -> list[dict[str, Any]]:
    """The same in steps: edges of a push are no straight ramps."""
    step = RAMP_S / STEPS
    up = [bench.push(PUSH_NM * (i + 0.5) / STEPS, START_S + i * step, step) for i in range(STEPS)]
    return [*up, bench.push(PUSH_NM, START_S + RAMP_S, HOLD_S)]


def ideal(joint: Joint) -> Seen:
    def still(t: float, x: Any) -> np.ndarray:
        return joint.law(x, 0.0, 0.0, 0.0)

    def led(t: float, x: Any) -> np.ndarray:
        s = min(t / MOVE_S, 1.0)
        q_d = MOVE_RAD * (10 * s**3 - 15 * s**4 + 6 * s**5)
        v_d = MOVE_RAD * (30 * s**2 - 60 * s**3 + 30 * s**4) / MOVE_S
        return joint.law(x, q_d, v_d, 0.0)

    def level(t: float, x: Any) -> np.ndarray:
        return joint.law(x, 0.0, 0.0, WEIGHT_NM)

    arm = joint.plant()
    end = RAMP_S + HOLD_S + FREE_S
    push = run(arm, still, end, lambda t: np.array([float(pushed(t))]), joint.drives())
    path = run(arm, led, MOVE_S, drives=joint.drives())
    rest = run(arm, level, REST_S, lambda t: np.array([-WEIGHT_NM]), joint.drives(False))
    s = path.t / MOVE_S
    wanted = MOVE_RAD * (10 * s**3 - 15 * s**4 + 6 * s**5)
    middle = np.abs(s - 0.5) < 0.125
    behind = float((wanted - path.x.q[:, 0])[middle].mean())
    return _seen(push.t, push.x.q[:, 0], behind, -float(rest.x.q[-1, 0]))


def bus(context: Context, joint: Joint) -> Seen:
    name = joint.name.replace(",", "").replace(" ", "_")
    gains = bench.spring_damper(K, float(D), position="static" if joint.static else "motor")
    real = {"changes": joint.changes(), "reality": joint.reality()}
    end = START_S + RAMP_S + HOLD_S + FREE_S
    log = bench.on_bus(context, f"{name}_push", gains, pushes(), end, **real)
    before = bench.mean(log, START_S - 0.2, START_S)
    push = bench.truth(log, START_S, end)
    goal = {"at_s": START_S, "goal": {"joints_rad": [MOVE_RAD], "duration_s": MOVE_S}}
    log = bench.on_bus(context, f"{name}_path", gains, [goal], START_S + MOVE_S, **real)
    middle = START_S + MOVE_S / 2
    behind = bench.lag(log, middle - 0.5, middle + 0.5)
    level = {
        "changes": {
            **joint.changes(),
            "gravity_m_per_s2": [0.0, -WEIGHT_NM / bench.LINK_MASS_M, 0.0],
        },
        "reality": joint.reality(friction=False),
        "start_q": [np.pi / 2],
    }
    log = bench.on_bus(context, f"{name}_level", gains, [], START_S + REST_S, **level)
    sag = bench.lag(log, START_S + REST_S - 0.2, START_S + REST_S)
    return _seen(push["t"] - START_S, push["q"] - before, behind, sag)


def _seen(t: np.ndarray, q: np.ndarray, lag: float, sag: float) -> Seen:
    up = (t > 0.4 * RAMP_S) & (t < 0.95 * RAMP_S)  # friction slips, the ramp goes on
    slope = np.polyfit(pushed(t[up]), q[up], 1)[0]
    let_go = RAMP_S + HOLD_S
    held = q[(t > let_go - 0.05) & (t < let_go)].mean()
    free = t >= let_go
    return Seen(1 / slope, float(-q[free].min() / held), lag, sag, t[free] - let_go, q[free])
