"""Joints with motors behind springs under sampled laws, linear between the samples and so exact.

M q̈ + G q = τ_t - d_q q̇ + τ_ext,   B θ̈ = τ_m - τ_t - τ_f,   τ_t = K (θ - q) + D (θ̇ - q̇)
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from limber.arrays import Floats
from limber_lecture.plants import held

PERIOD_S = 1e-3  # of the controller, whose torque comes one period late
FRICTION_STEPS = 2  # a period of that loop: bristles are stiff


@dataclass(frozen=True)
class ElasticArm:
    """M, G: n x n, kg m², N m/rad; the others one a joint."""

    M: Floats
    B: Floats
    K: Floats
    D: Floats
    G: Floats | float = 0.0  # stiffness of gravity
    link_damping: Floats | float = 0.0
    motor_damping: Floats | float = 0.0

    @property
    def size(self) -> int:
        return len(self.B)

    def matrices(self) -> tuple[Floats, Floats]:
        """ẋ = A x + E (τ_m, τ_ext) with x = (q, θ, q̇, θ̇)."""
        n, zero, one = self.size, np.zeros((self.size,) * 2), np.eye(self.size)
        K, D = np.diag(self.K), np.diag(self.D)
        stiffness = np.block([[K + self.G, -K], [-K, K]])
        link, motor = (np.diag(d * np.ones(n)) for d in (self.link_damping, self.motor_damping))
        damping = np.block([[D + link, -D], [-D, D + motor]])
        inertia = np.block([[self.M, zero], [zero, np.diag(self.B)]])
        A = np.zeros((4 * n, 4 * n))
        A[: 2 * n, 2 * n :] = np.eye(2 * n)
        A[2 * n :] = -np.linalg.solve(inertia, np.hstack([stiffness, damping]))
        E = np.zeros((4 * n, 2 * n))
        E[2 * n :] = np.linalg.solve(inertia, np.block([[zero, one], [one, zero]]))
        return A, E


def one_joint(M: float, B: float, K: float, D: float, **others: float) -> ElasticArm:
    return ElasticArm(np.array([[M]]), np.array([B]), np.array([K]), np.array([D]), **others)


@dataclass(frozen=True)
class Drives:
    """Torque loop τ_m = κ (ρ u + (1 - ρ) τ_t), and LuGre friction of the motors."""

    rho: float = 1.0
    rate_hz: float = 4000.0  # of the loop
    kappa: float = 1.0  # true torque constant over the one assumed
    coulomb: Floats | float = 0.0  # N m
    bristle_rad: float = 1e-4


class State(NamedTuple):
    q: Floats
    theta: Floats
    v: Floats
    theta_dot: Floats


@dataclass
class Track:
    """One row a period: time, state, torque of the spring and of the motor; n each."""

    t: Floats
    x: State
    tau: Floats
    tau_m: Floats


Law = Callable[[float, State], Floats]
# x a period later, of x, the controller's torque and that of a push
Advance = Callable[[Floats, Floats, Floats], Floats]


@dataclass
class Motors:
    """What drives and friction make of the controller's torque u between two periods."""

    arm: ElasticArm
    drives: Drives
    bristle: Floats = field(init=False)
    of_u: float = field(init=False)
    of_x: Floats = field(init=False)  # n x 4n: τ_m = of_u u + of_x x

    def __post_init__(self) -> None:
        rho, kappa = self.drives.rho, self.drives.kappa
        K, D = np.diag(self.arm.K), np.diag(self.arm.D)
        self.bristle = np.zeros(self.arm.size)
        self.of_u = kappa * rho
        self.of_x = kappa * (1 - rho) * np.hstack([-K, K, -D, D])

    def torque(self, u: Floats, x: Floats) -> Floats:
        return self.of_u * u + self.of_x @ x

    def linear(self, A: Floats, E: Floats, loops: int) -> Advance:
        """Without friction: all loops of a period at once, from the matrices of one."""
        n = self.arm.size
        one = A + E[:, :n] @ self.of_x
        whole = np.linalg.matrix_power(one, loops)
        inputs = sum(np.linalg.matrix_power(one, i) for i in range(loops)) @ E
        of_u, of_push = self.of_u * inputs[:, :n], inputs[:, n:]
        return lambda x, u, tau_ext: whole @ x + of_u @ u + of_push @ tau_ext

    def rubbed(self, A: Floats, E: Floats, loops: int, step_s: float) -> Advance:
        """With friction in each step of each loop; A and E are of a step."""
        n = self.arm.size

        def advance(x: Floats, u: Floats, tau_ext: Floats) -> Floats:
            pushed = E[:, n:] @ tau_ext
            for _ in range(loops):
                tau_m = self.torque(u, x)
                for _ in range(FRICTION_STEPS):
                    x = A @ x + E[:, :n] @ (tau_m - self.friction(x[3 * n :], step_s)) + pushed
            return x

        return advance

    def friction(self, speed: Floats, step_s: float) -> Floats:
        """Bristles that bend up to bristle_rad, where they slip; exact for a constant speed."""
        z_max = self.drives.bristle_rad
        slip = np.abs(speed) / z_max
        towards = np.sign(speed) * z_max
        self.bristle = towards + (self.bristle - towards) * np.exp(-slip * step_s)
        return self.drives.coulomb * self.bristle / z_max


def run(
    arm: ElasticArm,
    law: Law,
    seconds: float,
    push: Callable[[float], Floats] | None = None,
    drives: Drives | None = None,
    start: State | None = None,
) -> Track:
    """From rest, or from `start`. `law` sees the state now; its torque u acts a period later."""
    n, drives = arm.size, drives or Drives()
    steps = FRICTION_STEPS if np.any(drives.coulomb) else 1
    loops = round(PERIOD_S * drives.rate_hz) if drives.rho != 1 or steps > 1 else 1
    step_s = PERIOD_S / loops / steps
    A, E = held(*arm.matrices(), step_s)
    x: Floats = np.zeros(4 * n) if start is None else np.concatenate(start)
    motors = Motors(arm, drives)
    u: Floats = np.zeros(n)
    rows: list[tuple[float, Floats, Floats]] = []
    advance = motors.linear(A, E, loops) if steps == 1 else motors.rubbed(A, E, loops, step_s)
    for k in range(round(seconds / PERIOD_S)):
        t, now = k * PERIOD_S, State(*x.reshape(4, n))
        tau_ext = np.zeros(n) if push is None else push(t)
        next_u = law(t, now)
        rows.append((t, x, motors.torque(u, x)))
        x = advance(x, u, tau_ext)
        u = next_u
    return _track(arm, rows)


def _track(arm: ElasticArm, rows: list[tuple]) -> Track:
    t, x, tau_m = (np.array(column) for column in zip(*rows, strict=True))
    state = State(*np.moveaxis(x.reshape(len(t), 4, arm.size), 1, 0))
    return Track(t, state, arm.K * (state.theta - state.q), tau_m)
