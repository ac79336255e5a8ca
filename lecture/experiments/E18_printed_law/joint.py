"""τ_m = -K_pm (θ - q) - K_vm (θ̇ - q̇): the law steers the spring's deflection, and has no goal."""

from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.special import ellipk

from limber.errors import RunError
from limber.model.scenario import GAINS_S
from limber_lecture import testbench as bench
from limber_lecture.context import Context
from limber_lecture.plants import held

SPRING, GRAVITY = 60.0, 20.0  # N m/rad; N m that the link weighs when it lies
PUSH_NM, PUSH_S, JUDGED_S = 1.0, 2.5, (0.5, 1.5)
START = 2.0  # rad from hanging
SWING_S = 6.0


def inertia(K_pm: float) -> float:
    """M + B/(1 + K_pm/K_J)."""
    return bench.M + bench.B / (1 + K_pm / SPRING)


def fall_time(K_pm: float, height: float) -> float:
    """Of a pendulum with that inertia, from rest at `height` to where it hangs."""
    omega = np.sqrt(GRAVITY * bench.LINK_MASS_M / inertia(K_pm))
    return float(ellipk(np.sin(height / 2) ** 2) / omega)


def damper(K_pm: float) -> float:
    """K_vm, N m s/rad, in proportion to the joint's own: with less the law feeds a swing."""
    return K_pm / SPRING * bench.D_J


def _law(K_pm: float) -> np.ndarray:
    return np.array([K_pm, damper(K_pm), -K_pm, -damper(K_pm)])  # on (q, q̇, θ, θ̇)


def acceleration(t: np.ndarray, q: np.ndarray) -> float:
    """Of the link while the push lasts, after the spring has come to rest."""
    judged = (t > JUDGED_S[0]) & (t < JUDGED_S[1])
    return float(2 * np.polyfit(t[judged], q[judged], 2)[0])


def acceleration_model(K_pm: float) -> float:
    T = 1e-3
    plant, inputs = bench.elastic(SPRING)
    A, b = held(plant + inputs[:, :1] @ _law(K_pm)[None], inputs[:, 1:], T)
    x, track = np.zeros(4), [0.0]
    for _ in range(round(JUDGED_S[1] / T)):
        x = A @ x + b[:, 0] * PUSH_NM
        track.append(x[0])
    return acceleration(np.arange(len(track)) * T, np.array(track))


def fall(t: np.ndarray, q: np.ndarray, v: np.ndarray) -> tuple[float, float]:
    """Height of the first turning point, rad, and the time from there to the bottom, s."""
    turns = np.flatnonzero(v[:-1] * v[1:] < 0)
    for turn in turns:
        bottom = np.flatnonzero(q[turn:-1] * q[turn + 1 :] <= 0)
        if len(bottom) > 0 and abs(q[turn]) > 0.3:
            rest = _crossing(t, v, int(turn))
            return abs(float(q[turn])), _crossing(t, q, int(turn + bottom[0])) - rest
    raise RunError("the link does not fall")


def _crossing(t: np.ndarray, x: np.ndarray, i: int) -> float:
    return float(t[i] - x[i] * (t[i + 1] - t[i]) / (x[i + 1] - x[i]))


def fall_model(K_pm: float, height: float) -> tuple[np.ndarray, np.ndarray]:
    """Time and angle of the link, let go at `height`."""
    A, inputs = bench.elastic(SPRING)
    A = A + inputs[:, :1] @ _law(K_pm)[None]

    def rate(_: float, x: np.ndarray) -> np.ndarray:
        return A @ x - inputs[:, 1] * bench.weight(x[0], GRAVITY)

    # with the deflection that a free fall begins with, so that the spring does not ring
    a = -bench.weight(height, GRAVITY) / inertia(K_pm)
    deflection = -bench.B * a / (K_pm + SPRING)
    t = np.linspace(0, 1.5, 3001)
    first = [height, 0.0, height + deflection, 0.0]
    found = solve_ivp(rate, (0, 1.5), first, t_eval=t, method="LSODA", rtol=1e-9, atol=1e-11)
    return t, found.y[0]


def fall_time_model(K_pm: float, height: float) -> float:
    t, q = fall_model(K_pm, height)
    return _crossing(t, q, int(np.flatnonzero(q[:-1] * q[1:] <= 0)[0]))


def _bench(gravity: float) -> dict[str, Any]:
    """Fine steps of the torque; a law that holds the joint before may not be too stiff for it."""
    softer = {"K_q_Nm_per_rad": 35.0, "K_x_translation_N_per_m": 40.0}
    fine = bench.motor(rated_torque_Nm=1.0, peak_torque_Nm=32.0)
    return {**bench.gravity(gravity), **bench.sprung(SPRING), **fine, "gains": softer}


def _gains(K_pm: float) -> dict[str, Any]:
    return {"law": "deflection_pd", **bench.given(K_pm, damper(K_pm))}


def pushed_bus(context: Context, K_pm: float) -> float:
    end = PUSH_S + JUDGED_S[1]
    push, name = bench.push(PUSH_NM, PUSH_S, JUDGED_S[1] + 0.04), f"push_{K_pm:g}"
    log = bench.on_bus(context, name, _gains(K_pm), [push], end, changes=_bench(0.0))
    seen = bench.truth(log, PUSH_S, end)
    return acceleration(seen["t"] - PUSH_S, seen["q"])


def fall_bus(context: Context, K_pm: float) -> tuple[float, float, np.ndarray, np.ndarray]:
    """Height, time to the bottom; time and angle of all of it."""
    robot = {"changes": _bench(GRAVITY), "start_q": [START]}
    log = bench.on_bus(context, f"fall_{K_pm:g}", _gains(K_pm), [], SWING_S, **robot)
    seen = bench.truth(log, bench.SETTLED_S, SWING_S)
    height, time = fall(seen["t"], seen["q"], seen["v"])
    whole = bench.truth(log, 0.9, SWING_S)
    return height, time, whole["t"] - GAINS_S, whole["q"]
