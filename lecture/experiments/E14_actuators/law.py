"""The laws that the actuators are tried under, and what spoils them."""

import math
from dataclasses import dataclass

from limber_lecture import testbench as bench

INERTIA = bench.M + bench.B  # a rigid joint carries its rotor
SOFT, STIFF = (100.0, 10.0), (6000.0, 80.0)  # N m/rad, N m s/rad
KAPPA = 0.8  # true torque constant over the one that the drive believes in
PUSH_NM, GRAVITY = 10.0, 20.0  # N m, m/s²
HORIZONTAL = math.pi / 2  # rad: the link's angle where gravity pulls most
COULOMB_NM = 2.0
LAGS_S = (5e-3, 2e-3)  # of the current loop
RING_D = 2.0  # N m s/rad: little enough to ring
VOLTAGE_D = 4.0  # N m s/rad that the back EMF is to add


@dataclass(frozen=True)
class Hydraulic:
    """τ' = K_h (c_l u - D_h q̇ - c_l τ)."""

    K_h: float = 5e8  # N m/m³
    c_l: float = 4e-7  # m³/s/(N m)
    D_h: float = 2e-6  # m³/rad

    @property
    def lag(self) -> float:
        return 1 / (self.K_h * self.c_l)

    @property
    def damping(self) -> float:
        return self.D_h / self.c_l


HYDRAULIC = Hydraulic()
