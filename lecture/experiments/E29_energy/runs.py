"""ideal7 pushed far aside and let go: kinetic energy and the law's spring energy from then on."""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.spatial.transform import Rotation

from limber.model.robot import load_robot
from limber_lecture.context import Context
from limber_lecture.timeline import tip_gains
from limber_lecture.truth import joints, motion, status, time_s
from limber_lecture.variants import variant

K = np.array([300.0] * 3 + [2.0] * 3)
FORCE_N, TORQUE_NM = np.array([-30.0, 15.0, 40.0]), np.array([0.4, -0.3, 0.1])
PUSH_S, LET_GO_S = 2.0, 6.0
DAMPED_S, UNDAMPED_S = 3.0, 0.4  # looked at
UNDAMPED_SHARE = 0.3  # of the push: without damping the wrist gets faster
ZETA = 0.3
D_JOINTS = [2.0, 2.0, 2.0, 2.0, 0.3, 0.2, 0.03]  # N m s/rad, so that the elbow does not wander
RATES_HZ = (1000, 500)


@dataclass(frozen=True)
class Fall:
    """From the moment the push is over."""

    t: np.ndarray
    q: np.ndarray
    v: np.ndarray
    kinetic: np.ndarray
    spring: np.ndarray
    distance: float  # from the goal at the start, m
    goal: tuple[np.ndarray, Rotation]

    @property
    def total(self) -> np.ndarray:
        return self.kinetic + self.spring

    @property
    def risen(self) -> float:
        """By how much the energy has come to lie above its lowest so far, at most, J."""
        return float((self.total - np.minimum.accumulate(self.total)).max())


def fall(context: Context, rate_hz: int, damped: bool) -> Fall:
    robot = variant(context.out, "ideal7", {"rate_hz": rate_hz})
    null = {"K_null_Nm_per_rad": 0.0, "D_null_Nms_per_rad": D_JOINTS}
    bounds = {"spring_force_N": 1000.0, "spring_moment_Nm": 200.0}
    gains = tip_gains(K[:3], K[3:], model_compensation="gravity", damping_ratio=ZETA)
    share = 1.0 if damped else UNDAMPED_SHARE
    push = {"id": 1, "force_N": share * FORCE_N, "torque_Nm": share * TORQUE_NM}
    undamped = {"damping_ratio": 0.0, "D_null_Nms_per_rad": 0.0}
    entries = [
        # a choice holds at once: not before the numbers, which ramp, have come down
        {"at_s": 1.5, "gains": {"projector": "none"}},
        {"at_s": PUSH_S, "push": {**push, "ramp_s": 1.0, "for_s": 60.0}},
        *([] if damped else [{"at_s": LET_GO_S - 0.5, "gains": undamped}]),
        {"at_s": LET_GO_S, "push": {"id": 1, "force_N": [0.0, 0.0, 0.0], "for_s": 60.0}},
    ]
    end = LET_GO_S + (DAMPED_S if damped else UNDAMPED_S)
    name = f"{'damped' if damped else 'undamped'}_{rate_hz}"
    log = context.run_law(name, robot, {**gains, **null, **bounds}, entries, end)
    told = status(log, LET_GO_S, end)
    rows = motion(log, LET_GO_S, end)
    rows = rows[np.abs(rows["F_push"]).max(axis=1) == 0]
    goal = told["p_BD"][0], Rotation.from_quat(told["quat_BD"][0], scalar_first=True)
    turned = Rotation.from_quat(rows["quat_BT"], scalar_first=True)
    return Fall(
        t=time_s(rows) - time_s(rows)[0],
        q=joints(rows),
        v=joints(rows, "v"),
        kinetic=rows["kinetic_energy_J"],
        spring=energy(rows["p_BT"], turned, goal),
        distance=float(np.linalg.norm(rows["p_BT"][0] - goal[0])),
        goal=goal,
    )


def fed_in(run: Fall, rate_hz: int) -> np.ndarray:
    """What delay feeds in over time: -t_d ∫ vᵀ (∂τ/∂q) v dt, with t_d = 1.5 periods and τ all that
    the controller takes from the position: -∂τ/∂q = ∂²U/∂q² - ∂g/∂q, U the spring's energy.
    """
    robot = load_robot("ideal7")

    def spring(q: np.ndarray) -> float:
        X = robot.chain.forward(q)
        return float(energy(X[None, :3, 3], Rotation.from_matrix(X[None, :3, :3]), run.goal)[0])

    few = slice(None, None, rate_hz // 250)
    step = 1e-3  # s
    changes = robot.dynamics.gravity_rate(run.q[few], run.v[few])
    power = []
    for q, v, change in zip(run.q[few], run.v[few], changes, strict=True):
        curved = spring(q + step * v) - 2 * spring(q) + spring(q - step * v)
        power.append(curved / step**2 - v @ change)
    gained = cumulative_trapezoid(power, run.t[few], initial=0.0)
    return np.interp(run.t, run.t[few], 1.5 / rate_hz * gained)


def energy(p: np.ndarray, R: Rotation, goal: tuple[np.ndarray, Rotation]) -> np.ndarray:
    """½ eᵀ K e with e = (p - p_d, Log R R_dᵀ), for many poses."""
    e = np.hstack([p - goal[0], (R * goal[1].inv()).as_rotvec()])
    return (e**2 * K).sum(axis=1) / 2
