"""A series elastic joint whose motor stands still: how it rings, and what an impact costs."""

from typing import Any

import numpy as np

from limber_lecture import testbench as bench
from limber_lecture.context import Comparison, Context
from limber_lecture.elastic import State, one_joint, run
from limber_lecture.pictures import BLUE, MARKS, Axes, name_axes
from limber_lecture.ringdown import Mode, mode_seen

from .tracking import K_S, START_S

D_S = 0.5  # N m s/rad
STIFFNESS = (300.0, 5000.0)  # N m/rad, of the two joints that are hit
PUSH_NM, PUSH_S, RING_S = 3.0, 1.0, 3.0
HIT_NM, HIT_S = 50.0, 5e-3
EVERY = 10  # samples between two that are fitted


def ring_ideal() -> Mode:
    rows = _free(K_S, D_S, q=0.01, v=0.0, seconds=RING_S)
    return mode_seen(rows.x.q[:, 0], rows.x.v[:, 0], EVERY)


def ring_bus(context: Context) -> Mode:
    let_go = START_S + PUSH_S
    push = bench.push(PUSH_NM, START_S, PUSH_S)
    end = let_go + RING_S
    log = bench.on_bus(context, "ring", bench.FREE, [push], end, **clamped(K_S, D_S))
    seen = bench.sensed(log, let_go + 0.01, end)
    return mode_seen(seen["q"], seen["v"], EVERY)


def clamped(K: float, D: float) -> dict[str, Any]:
    """How the bench is changed, and what is so in plant_overrides."""
    return {"changes": bench.sprung(K, D), "plant_overrides": bench.CLAMPED}


def _free(K: float, D: float, q: float, v: float, seconds: float) -> Any:
    """The motor as heavy as if it were clamped."""
    arm = one_joint(bench.M, bench.FAST_KGM2, K, D)
    zero = np.zeros(1)
    start = State(np.array([q]), zero, np.array([v]), zero)
    return run(arm, lambda t, x: zero, seconds, start=start)


def impact_ideal(K: float) -> float:
    """Greatest torque for 1 rad/s."""
    return float(np.abs(_free(K, 0.0, 0.0, 1.0, 0.4).tau).max())


def impact_bus(context: Context, K: float) -> float:
    """Greatest torque at the sensor over the link's speed where the spring is relaxed."""
    hit, end = bench.push(HIT_NM, START_S, HIT_S), START_S + 0.5
    log = bench.on_bus(context, f"hit_{K:g}", bench.FREE, [hit], end, **clamped(K, 0.0))
    seen = bench.sensed(log, START_S + HIT_S + 2e-3, end)
    q, v = seen["q"], seen["v"]
    before = np.flatnonzero(q[:-1] * q[1:] < 0)
    share = q[before] / (q[before] - q[before + 1])
    speeds = np.abs(v[before] + share * (v[before + 1] - v[before]))
    return float(np.abs(seen["tau"]).max() / speeds.mean())


def checks(context: Context) -> list[Comparison]:
    omega, zeta = np.sqrt(K_S / bench.M), D_S / (2 * np.sqrt(K_S * bench.M))
    made = []
    for where, mode in (("ideal", ring_ideal()), ("bus", ring_bus(context))):
        name = f"motor clamped, link let go, {where}"
        made.append(Comparison(f"{name}: frequency", omega, mode.omega, "rad/s", 0.01))
        made.append(Comparison(f"{name}: damping ratio", zeta, mode.zeta, "", 0.01))
    for K in STIFFNESS:
        for where, peak in (("ideal", impact_ideal(K)), ("bus", impact_bus(context, K))):
            name = f"impact on a spring of {K:g} N m/rad, {where}: torque for 1 rad/s"
            made.append(Comparison(name, np.sqrt(K * bench.M), peak, "N m", 0.01))
    return made


def draw(made: list[Comparison], ax: Axes) -> None:
    K = np.geomspace(50, 2e4, 60)
    ax.loglog(K, np.sqrt(K * bench.M), color=BLUE, label="√(K M)")
    for where, style in MARKS.items():
        hits = [c.measured for c in made if c.name.startswith("impact") and f", {where}:" in c.name]
        ax.loglog(STIFFNESS, hits, **style, color=BLUE, label=where)
    ax.set_title("Hit on a joint whose motor stands still")
    name_axes(ax, "stiffness of the spring (N m/rad)", "greatest torque for 1 rad/s (N m)", "best")
