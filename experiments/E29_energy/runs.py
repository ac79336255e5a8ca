"""ideal7 pushed far aside and let go: kinetic energy and the law's spring energy from then on."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.spatial.transform import Rotation

from limber.experiments.context import Context
from limber.experiments.inertia import gravity_rate
from limber.experiments.truth import joints, motion, seconds, status
from limber.experiments.variants import variant
from limber.robot import load_robot

K = np.array([300.0] * 3 + [2.0] * 3)
FORCE_N, TORQUE_NM = [-30.0, 15.0, 40.0], [0.4, -0.3, 0.1]
PUSH_S, LET_GO_S = 2.0, 6.0
DAMPED_S, UNDAMPED_S = 3.0, 0.4  # looked at
UNDAMPED_SHARE = 0.3  # of the push: without damping the wrist gets faster
ZETA = 0.3
D_JOINTS = [2.0, 2.0, 2.0, 2.0, 0.3, 0.2, 0.03]  # N m s/rad, so that the elbow does not wander
RATES_HZ = (1000, 2000)


@dataclass(frozen=True)
class Fall:
    """From the moment the push is over."""

    t: np.ndarray
    kinetic: np.ndarray
    spring: np.ndarray
    off: np.ndarray  # pose error, m and rad
    q: np.ndarray
    v: np.ndarray

    @property
    def total(self) -> np.ndarray:
        return self.kinetic + self.spring

    @property
    def risen(self) -> float:
        """By how much the energy has come to lie above its lowest so far, at most, J."""
        return float((self.total - np.minimum.accumulate(self.total)).max())


def at_rate(rate_hz: float) -> dict[str, Any]:
    """Two joints a bus and 8 Mbit/s: that lets ideal7 run at 2 kHz."""
    names = ["base", "shoulder", "elbow", "wrist"]
    buses = [
        {"name": name, "can": f"virtual:ideal7_{name}", "fd": True,
         "bitrate_bps": 1000000, "data_bitrate_bps": 8000000}
        for name in names
    ]  # fmt: skip
    joints = {f"joint_{i + 1}": {"bus": names[i // 2]} for i in range(7)}
    return {"rate_hz": rate_hz, "buses": buses, "joints": joints}


def fall(context: Context, rate_hz: int, damped: bool) -> Fall:
    robot = variant(context.out, "ideal7", at_rate(rate_hz))
    gains = {
        "law": "cartesian_impedance",
        "bias": "gravity",
        "K_x_translation_N_per_m": K[:3].tolist(),
        "K_x_rotation_Nm_per_rad": K[3:].tolist(),
        "damping_ratio": ZETA,
        "K_null_Nm_per_rad": 0.0,
        "D_null_Nms_per_rad": D_JOINTS,
        "spring_force_N": 1000.0,
        "spring_moment_Nm": 200.0,
    }
    share = 1.0 if damped else UNDAMPED_SHARE
    push = {
        "id": 1,
        "force_N": [share * f for f in FORCE_N],
        "torque_Nm": [share * m for m in TORQUE_NM],
    }
    undamped = {"damping_ratio": 0.0, "D_null_Nms_per_rad": 0.0}
    end = LET_GO_S + (DAMPED_S if damped else UNDAMPED_S)
    scenario = {
        "robot": robot,
        "integrator": "reference",
        "duration_s": end + 0.1,
        "timeline": [
            {"at_s": 0.3, "mode": "hold"},
            {"at_s": 0.8, "mode": "active"},
            {"at_s": 1.0, "gains": gains},
            # a choice holds at once: not before the numbers, which ramp, have come down
            {"at_s": 1.5, "gains": {"projector": "none"}},
            {"at_s": PUSH_S, "push": {**push, "ramp_s": 1.0, "for_s": 60.0}},
            *([] if damped else [{"at_s": LET_GO_S - 0.5, "gains": undamped}]),
            {"at_s": LET_GO_S, "push": {"id": 1, "force_N": [0.0, 0.0, 0.0], "for_s": 60.0}},
        ],
    }
    log = context.lab(scenario, f"{'damped' if damped else 'undamped'}_{rate_hz}")
    told = status(log, LET_GO_S, end)
    rows = motion(log, LET_GO_S, end)
    rows = rows[np.abs(rows["F_push"]).max(axis=1) == 0]
    goal = Rotation.from_quat(np.roll(told["quat_BD"][0], -1))
    turned = (Rotation.from_quat(np.roll(rows["quat_BT"], -1, axis=1)) * goal.inv()).as_rotvec()
    e = np.hstack([rows["p_BT"] - told["p_BD"][0], turned])
    return Fall(
        t=seconds(rows) - seconds(rows)[0],
        kinetic=rows["kinetic_energy_J"],
        spring=(e**2 * K).sum(axis=1) / 2,
        off=e,
        q=joints(rows),
        v=joints(rows, "v"),
    )


def fed_in(run: Fall, rate_hz: int) -> np.ndarray:
    """What delay feeds in over time: -t_d ∫ vᵀ (∂τ/∂q) v dt, with t_d = 1.5 periods and τ all that
    the controller takes from the position: -∂τ/∂q = Jᵀ AᵀKA J - ∂g/∂q.
    """
    chain = load_robot("ideal7").chain
    few = slice(None, None, rate_hz // 250)
    power = []
    for q, v, e in zip(run.q[few], run.v[few], run.off[few], strict=True):
        rate = error_rate(e) @ chain.jacobian(q) @ v
        power.append(rate @ (K * rate) - v @ gravity_rate("ideal7", q, v))
    gained = cumulative_trapezoid(power, run.t[few], initial=0.0)
    return np.interp(run.t, run.t[few], 1.5 / rate_hz * gained)


def error_rate(e: np.ndarray) -> np.ndarray:
    """A: ė = A V for e = (p - p_d, Log R R_dᵀ); inverse left Jacobian of the rotation."""
    phi = np.linalg.norm(e[3:])
    x, y, z = e[3:]
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    third = (1 / phi**2 - (1 + np.cos(phi)) / (2 * phi * np.sin(phi))) if phi > 1e-4 else 1 / 12
    A = np.eye(6)
    A[3:, 3:] += -cross / 2 + third * cross @ cross
    return A
