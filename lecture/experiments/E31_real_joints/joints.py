"""Five joints that are given the same gains, and what formulas say each makes of them."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from limber_lecture import testbench as bench
from limber_lecture import variants
from limber_lecture.elastic import Drives, ElasticArm, State, one_joint
from limber_lecture.plants import held
from limber_lecture.sampled_damping import STABLE_SHARE, damped
from limber_lecture.testbench import CYCLE_S, B, M

LEVER_M = 0.5  # from the joint to the tip
K = 500.0  # N m/rad asked of each joint: 2000 N/m at the tip
ZETA = 0.3  # asked
KAPPA, COULOMB_NM = 0.9, 2.0  # of a real motor
RHO = 4.0  # of the drive's torque loop
LOOP_HZ = 4000
RIGID = 1e6  # N m/rad, D 100: a spring that gives way to nobody, where there is none
WEIGHT_NM = 10.0  # of the link, held level


@dataclass(frozen=True)
class Joint:
    """`static`: the law looks where the link would rest, not at the motor."""

    name: str
    spring: float = RIGID  # N m/rad
    damper: float = 100.0  # N m s/rad
    kappa: float = KAPPA
    coulomb: float = COULOMB_NM
    rho: float = 1.0
    static: bool = False

    @property
    def rigid(self) -> bool:
        return self.spring == RIGID

    @property
    def share(self) -> float:
        """γ: torque delivered over torque asked for, at rest."""
        return self.kappa * self.rho / (1 + self.kappa * (self.rho - 1))

    @property
    def yields(self) -> float:
        """Compliance of the spring, rad/(N m)."""
        return 0.0 if self.rigid else 1 / self.spring

    @property
    def stiffness(self) -> float:
        """In series with the spring, unless the law counts it in; γ is off there, too."""
        series = 1 - 1 / self.share if self.static else 1.0
        return 1 / (1 / (self.share * K) + series * self.yields)

    @property
    def lag(self) -> float:
        """On a path, rad: friction, divided by the torque loop, over the law's stiffness."""
        left = self.coulomb / (self.kappa * self.rho)
        return left * (1 / K - (self.yields if self.static else 0.0))

    @property
    def sag(self) -> float:
        """Under a weight that is compensated, rad."""
        missing = 1 / self.share - 1
        spring = -missing if self.static else 1.0
        return WEIGHT_NM * (missing / K + spring * self.yields)

    @property
    def at_motor(self) -> float:
        """The law's stiffness there: where the spring is counted in, K in series with it."""
        return K * self.spring / (self.spring - K) if self.static else K

    @cached_property
    def design(self) -> tuple[float, float]:
        """Damping at the motor, and the link's damping ratio with it: ZETA, or the greatest.

        Of the joint that robot.yaml describes.
        """
        if self.rigid:
            return 2 * ZETA * np.sqrt(K * (M + B)), ZETA
        w = np.sqrt(1 / (1 / self.at_motor + 1 / self.spring) / M)
        return damped(self.cycle, w, ZETA, STABLE_SHARE * B / self.rho / CYCLE_S)

    def cycle(self, D: float) -> np.ndarray:
        """State (x, u) a period later: torque one cycle late, torque loop at 4 kHz."""
        loops = round(CYCLE_S * LOOP_HZ)
        A, E = held(*self.plant().matrices(), CYCLE_S / loops)
        torque = np.array([[-self.spring, self.spring, -self.damper, self.damper]])
        step = np.block(
            [
                [A + (1 - self.rho) * E[:, :1] @ torque, self.rho * E[:, :1]],
                [np.zeros((1, 4)), np.eye(1)],
            ]
        )
        cycle = np.linalg.matrix_power(step, loops)
        cycle[4] = [0.0, -self.at_motor, 0.0, -D, 0.0]
        return cycle

    def plant(self) -> ElasticArm:
        return one_joint(M, B, self.spring, self.damper)

    def drives(self, friction: bool = True) -> Drives:
        return Drives(self.rho, kappa=self.kappa, coulomb=self.coulomb if friction else 0.0)

    def law(self, x: State, q_d: float, v_d: float, weight: float) -> np.ndarray:
        """l(q) = weight - K (q - q_d) at the motor, or at q̄ with K_J (θ - q̄) = l(q̄)."""
        q = x.theta
        if self.static:
            q = (self.spring * x.theta - weight - K * q_d) / (self.spring - K)
        return weight - K * (q - q_d) - self.design[0] * (x.theta_dot - v_d)

    def changes(self) -> dict[str, Any]:
        """Of robot.yaml of the bench."""
        if self.rigid:
            return bench.joint(**bench.RIGID)
        loop = {"inertia_ratio": self.rho, "rate_hz": LOOP_HZ}
        return bench.sprung(self.spring, self.damper, torque_loop=loop)

    def plant_overrides(self, friction: bool = True) -> dict[str, Any]:
        """What robot.yaml does not know: the torque constant and the motor's friction."""
        coulomb = variants.friction(self.coulomb if friction else 0.0)
        return {**bench.torque_constant(self.kappa), **bench.joint(friction=coulomb)}


JOINTS = (
    Joint("perfect joint", kappa=1.0, coulomb=0.0),
    Joint("real motor"),
    Joint("flexible, no torque loop", spring=1500.0, damper=2.0),
    Joint("flexible, torque loop", spring=1500.0, damper=2.0, rho=RHO, static=True),
    Joint("series elastic", spring=300.0, damper=0.5),
)
