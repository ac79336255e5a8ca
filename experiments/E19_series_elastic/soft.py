"""The test bench with a soft spring, and what its encoders and its torque sensor say."""

from typing import Any

import numpy as np

from limber.experiments import testbench as bench
from limber.logs import Log

K_S = 300.0  # N m/rad
FAST_KGM2 = 1e6  # a rotor or link of this inertia, behind the gear, stays where it is
# In reality, whatever the motor is told; its torque at the joint is as before
CLAMPED = bench.motor(
    rotor_inertia_kgm2=1.0,
    gear_ratio=np.sqrt(FAST_KGM2).item(),
    rotor_torque_constant_Nm_per_A=1e-3,
)
FREE = {"law": "gravity_compensation"}  # no torque at all: the bench lies
START_S = 2.0  # of what is done to the joint


def sprung(K: float, D: float, **joint: Any) -> dict[str, Any]:
    """A change of the bench: its spring and damper, and more of its joint."""
    spring = {"stiffness_Nm_per_rad": K}
    return bench.joint(transmission={"spring": spring, "damping_Nms_per_rad": D}, **joint)


def viscous(d: float) -> dict[str, Any]:
    """Friction of the motor, N m s/rad."""
    return {"coulomb_Nm": 0.0, "viscous_Nms_per_rad": d}


def sensed(log: Log, start_s: float, end_s: float) -> dict[str, np.ndarray]:
    """Link encoder, its velocity, and torque sensor, as they came over the bus."""
    rows = log.read("JOINT_STATE")
    t = rows["time_ns"] * 1e-9
    rows = rows[(t >= start_s - 1e-6) & (t < end_s - 1e-6)]
    return {"t": rows["time_ns"] * 1e-9, **{name: rows[name][:, 0] for name in ("q", "v", "tau")}}
