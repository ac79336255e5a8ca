"""Each joint is pushed and let go, led round and round, and loaded with its weight.

Each on its equations with exact sensors (ideal) and behind a CiA 402 drive (bus).
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from limber_lecture import testbench as bench
from limber_lecture.context import Context
from limber_lecture.elastic import Drives, State, run
from limber_lecture.timeline import UNBOUNDED, tip_gains
from limber_lecture.truth import Log, motion, status, time_s

from .joints import LEVER_M, WEIGHT_NM, ZETA, Joint, K

PUSH_NM, RAMP_S, HOLD_S, FREE_S = 20.0, 1.0, 0.5, 1.5
STEPS = 100  # of the ramp
TURN_S, TURNING_S = 3.2, 0.6  # of a circle; the goal's speed rises over the first
REST_S = 4.0
START_S = 2.0


@dataclass(frozen=True)
class Seen:
    """`t` since the joint was let go, `q` less where it was before the push, rad."""

    stiffness: float  # N m/rad
    overshoot: float  # share of the way back
    lag: float  # rad
    sag: float  # rad
    as_told: float  # overshoot of a motor without friction, whose torque constant is right
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


def circle(t: float) -> tuple[float, float]:
    """Angle and speed of a goal that goes round and round."""
    speed = 2 * np.pi / TURN_S
    if t < TURN_S:
        turn = np.pi * t / TURN_S
        return speed * (t - np.sin(turn) * TURN_S / np.pi) / 2, speed * (1 - np.cos(turn)) / 2
    return speed * (t - TURN_S / 2), speed


def ideal(joint: Joint) -> Seen:
    arm = joint.plant()
    end = RAMP_S + HOLD_S + FREE_S
    drives = joint.drives()

    def still(t: float, x: State) -> np.ndarray:
        return joint.law(x, 0.0, 0.0, 0.0)

    def led(t: float, x: State) -> np.ndarray:
        return joint.law(x, *circle(t), 0.0)

    def level(t: float, x: State) -> np.ndarray:
        return joint.law(x, 0.0, 0.0, WEIGHT_NM)

    push = run(arm, still, end, lambda t: np.array([float(pushed(t))]), drives)
    path = run(arm, led, TURN_S + TURNING_S, drives=drives)
    rest = run(arm, level, REST_S, lambda t: np.array([-WEIGHT_NM]), joint.drives(False))
    late = path.t > TURN_S + 0.1
    wanted = np.array([circle(t)[0] for t in path.t[late]])
    behind = float((wanted - path.x.q[late, 0]).mean())
    told = run(arm, still, end, lambda t: np.array([float(pushed(t))]), Drives(joint.rho))
    as_told = _overshoot(told.t, told.x.q[:, 0])
    return _seen(push.t, push.x.q[:, 0], behind, -float(rest.x.q[-1, 0]), as_told)


def bus(context: Context, joint: Joint) -> Seen:
    """With the gains at the tip: K/l² there is K at the joint."""
    name = joint.name.replace(",", "").replace(" ", "_")
    K_tip = K / LEVER_M**2
    gains = tip_gains(
        [K_tip, K_tip, 0.0],
        position_feedback="static" if joint.static else "motor",
        damping_ratio=ZETA,
        **UNBOUNDED,
    )
    real = {"changes": joint.changes(), "plant_overrides": joint.plant_overrides()}
    end = START_S + RAMP_S + HOLD_S + FREE_S
    log = bench.on_bus(context, f"{name}_push", gains, pushes(), end, **real)
    push = _pushed_motion(log, end)
    told = bench.on_bus(context, f"{name}_told", gains, pushes(), end, changes=joint.changes())
    as_told = _overshoot(*_pushed_motion(told, end))
    turn = {"circle_centre_m": [0.0, LEVER_M, 0.0], "circle_axis": [0.0, 0.0, 1.0]}
    goal = {"at_s": START_S, "goal": {**turn, "duration_s": TURN_S}}
    end = START_S + TURN_S + TURNING_S
    # The goal does not turn on its circle, the tip does: a designed damper, which acts on both as
    # the joint moves them, would miss part of the goal's motion.
    D_tip = joint.design[0] / LEVER_M**2
    steady = {"damping": "given", "D_x": np.diag([D_tip, D_tip, 0.0, 0.0, 0.0, 0.0])}
    log = bench.on_bus(context, f"{name}_path", {**gains, **steady}, [goal], end, **real)
    behind = _behind(log, end - 0.5, end)
    level = bench.gravity(WEIGHT_NM / bench.LINK_MASS_M)
    real = {
        "changes": {**joint.changes(), **level},
        "plant_overrides": joint.plant_overrides(friction=False),
    }
    end = START_S + REST_S
    log = bench.on_bus(context, f"{name}_level", gains, [], end, **real, start_q=[np.pi / 2])
    return _seen(*push, behind, _behind(log, end - 0.2, end), as_told)


def _pushed_motion(log: Log, end_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Since the push began; the angle less where it was before."""
    before = bench.mean(log, START_S - 0.2, START_S)
    push = bench.truth(log, START_S, end_s)
    return push["t"] - START_S, push["q"] - before


def _behind(log: Log, start_s: float, end_s: float) -> float:
    """Angle from the tip to its goal, on average."""
    told, rows = status(log, start_s, end_s), motion(log, start_s, end_s)
    at = np.searchsorted(time_s(rows), time_s(told) - 1e-6)
    (x, y), (x_d, y_d) = rows["p_BT"][at, :2].T, told["p_BD"][:, :2].T
    return float(np.arctan2(x * y_d - y * x_d, x * x_d + y * y_d).mean())


def _seen(t: np.ndarray, q: np.ndarray, lag: float, sag: float, as_told: float) -> Seen:
    up = (t > 0.4 * RAMP_S) & (t < 0.95 * RAMP_S)  # friction slips, the ramp goes on
    slope = np.polyfit(pushed(t[up]), q[up], 1)[0]
    let_go = RAMP_S + HOLD_S
    free = t >= let_go
    through = _overshoot(t, q)
    return Seen(1 / slope, through, lag, sag, as_told, t[free] - let_go, q[free])


def _overshoot(t: np.ndarray, q: np.ndarray) -> float:
    let_go = RAMP_S + HOLD_S
    held = q[(t > let_go - 0.05) & (t < let_go)].mean()
    return float(-q[t >= let_go].min() / held)
