"""Each mode of the tip is pushed alone and let go: it swings through as its damping ratio says.

Motors as described, without friction. On the bus, and on the linearised sampled arm (ideal), whose
dampings are sought here mode by mode.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import eigh

from limber.model.robot import load_robot
from limber_lecture.context import Comparison, Context
from limber_lecture.elastic import PERIOD_S, Drives, one_joint, run
from limber_lecture.inertia import tip_inertia
from limber_lecture.pictures import Axes, name_axes
from limber_lecture.plants import held
from limber_lecture.sampled_damping import STABLE_SHARE, damped, overshoot
from limber_lecture.truth import joints, motion, status, time_s

from . import bus
from .arm import COULOMB_NM, D_J, D_NULL, K_J, K_X, ROBOT, B, Pose

ZETA = 0.3
ASKED = overshoot(ZETA)
FIRST_S, EACH_S = 2.5, 2.0
UP_S, HELD_S = 0.8, 0.4  # of a push
LET_GO_S = UP_S + HELD_S
FORCE_N, MOMENT_NM = 10.0, 1.0

Swing = tuple[np.ndarray, np.ndarray]  # time since the push began, share of where it was held


@dataclass(frozen=True)
class Modes:
    """K v = ω² Λ v with the rotors as they seem: motions v of the tip with vᵀ Λ v = 1."""

    pose: Pose

    @cached_property
    def inertia(self) -> np.ndarray:
        return tip_inertia(self.pose.J, self.pose.M + np.diag(B / self.pose.rho))

    @cached_property
    def motions(self) -> np.ndarray:
        """Rows, softest first."""
        return eigh(K_X, self.inertia)[1].T

    def wrench(self, v: np.ndarray) -> np.ndarray:
        """That moves this mode alone at rest; bounded."""
        F = K_X @ v
        return F * min(FORCE_N / np.linalg.norm(F[:3]), MOMENT_NM / np.linalg.norm(F[3:]))

    def along(self, v: np.ndarray, q: np.ndarray) -> np.ndarray:
        """Of small motions q of the joints."""
        return q @ self.pose.J.T @ self.inertia @ v

    @cached_property
    def damping(self) -> np.ndarray:
        """At the joints: each mode as a joint of its own, bent by the wrench Λ v."""
        D = D_NULL * self.pose.null
        for v in self.motions:
            torque = self.pose.J.T @ self.inertia @ v
            D += self.mode_damping(v, torque) * np.outer(torque, torque)
        return D

    def mode_damping(self, v: np.ndarray, torque: np.ndarray) -> float:
        """With which the pair of roots that begins as the link's has the ratio asked."""
        seeming = B / self.pose.rho
        u = np.linalg.solve(self.pose.M + np.diag(seeming), torque)
        rotor, bend = float(u @ (seeming * u)), torque / K_J
        spring = 1 / float(torque @ bend)
        damper = float(bend @ (D_J * bend)) * spring**2
        asked = float(v @ K_X @ v)
        law = asked * spring / (spring - asked)  # in series with the spring: as asked
        most = STABLE_SHARE / PERIOD_S / float(torque @ (torque / seeming))
        A, E = held(*one_joint(1 - rotor, rotor, spring, damper).matrices(), PERIOD_S)

        def cycle(D: float) -> np.ndarray:
            late = [0.0, -law, 0.0, -D, 0.0]
            return np.block([[A, E[:, :1]], [np.array([late])]])

        D, ratio = damped(cycle, np.sqrt(asked / (1 - rotor)), ZETA, most)
        if ratio < ZETA:
            raise ValueError(f"a mode of {asked**0.5:.1f} rad/s cannot be damped as asked")
        return D


def pushes(wrenches: list[np.ndarray]) -> list[dict]:
    """Up a ramp, held, and let go at once: a push replaces the one before."""
    made = []
    for i, F in enumerate(wrenches):
        at = FIRST_S + i * EACH_S
        push = {"id": 1, "force_N": F[:3].tolist(), "torque_Nm": F[3:].tolist()}
        made.append({"at_s": at, "push": {**push, "ramp_s": UP_S, "for_s": 2 * UP_S}})
        made.append({"at_s": at + UP_S, "push": {**push, "for_s": HELD_S}})
    return made


def on_bus(context: Context, modes: Modes) -> list[Swing]:
    wrenches = [modes.wrench(v) for v in modes.motions]
    end, rho = FIRST_S + len(wrenches) * EACH_S, modes.pose.rho
    name = f"released_{rho:g}"
    log = bus.run(context, name, rho, 0 * COULOMB_NM, pushes(wrenches), end, ratio=ZETA, kappa=1.0)
    status(log, FIRST_S, end)
    swings = []
    for i, v in enumerate(modes.motions):
        at = FIRST_S + i * EACH_S
        rows = motion(log, at - 0.1, at + EACH_S)
        t, q = time_s(rows) - at, joints(rows)
        swings.append(swing(t, modes.along(v, q - q[t < 0].mean(axis=0))))
    return swings


def linearised(modes: Modes) -> list[Swing]:
    pose, swings = modes.pose, []
    q_bar = np.linalg.solve(np.diag(K_J) - pose.stiffness, np.diag(K_J))

    def law(t: float, x) -> np.ndarray:
        return -pose.stiffness @ q_bar @ x.theta - modes.damping @ x.theta_dot

    for v in modes.motions:
        tau = pose.J.T @ modes.wrench(v)

        def pushed(t: float, tau: np.ndarray = tau) -> np.ndarray:
            return tau * (0.5 - 0.5 * np.cos(np.pi * min(t / UP_S, 1.0)) if t < LET_GO_S else 0.0)

        track = run(pose.plant(), law, EACH_S, pushed, Drives(pose.rho))
        swings.append(swing(track.t, modes.along(v, track.x.q)))
    return swings


def swing(t: np.ndarray, x: np.ndarray) -> Swing:
    return t, x / x[(t > LET_GO_S - 0.05) & (t < LET_GO_S)].mean()


def swung(seen: Swing) -> float:
    """Share of the way back, through."""
    t, x = seen
    return float(-x[t >= LET_GO_S].min())


def measure(context: Context, rho: float) -> dict[str, list[Swing]]:
    modes = Modes(Pose(load_robot(ROBOT).home, rho))
    return {"ideal": linearised(modes), "bus": on_bus(context, modes)}


def checks(rho: float, ways: dict[str, list[Swing]]) -> list[Comparison]:
    """The design takes the modes one by one; that springs couple them is in `ideal`."""
    made = []
    for i, (ideal, seen) in enumerate(zip(ways["ideal"], ways["bus"], strict=True)):
        name = f"inertia ratio {rho:g}: mode {i + 1} of the tip let go, overshoot, bus"
        made.append(Comparison(f"{name}, asked", ASKED, swung(seen), "", 0.035, "absolute"))
        model = f"{name} (prediction: ideal)"
        made.append(Comparison(model, swung(ideal), swung(seen), "", 0.005, "absolute"))
    return made


def draw(rho: float, ways: dict[str, list[Swing]], ax: Axes) -> None:
    for i, (ideal, seen) in enumerate(zip(ways["ideal"], ways["bus"], strict=True)):
        color = f"C{i}"
        label = f"mode {i + 1}: {100 * swung(seen):.0f} %"
        ax.plot(seen[0] - LET_GO_S, seen[1], color=color, label=label)
        ax.plot(ideal[0] - LET_GO_S, ideal[1], "--", color=color, lw=0.8)
    ax.set_xlim(-0.05, EACH_S - LET_GO_S)
    ax.set_title(f"Modes of the tip let go, ratio {rho:g}: overshoot, {100 * ASKED:.0f} % asked")
    name_axes(ax, "time (s); dashed: ideal", "along the mode, of where it was held", "upper right")
