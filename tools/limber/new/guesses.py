"""Starting values for what a URDF does not tell: drives, limits where it has none, gains.

They are made to give a soft, stable simulation, not to be right: each is marked in robot.yaml.
"""

from dataclasses import dataclass
from math import isfinite, pi, sqrt

import numpy as np

from limber.new.facts import ArmFacts, JointFacts
from limber.new.wiring import Motor

SOFT_rad_per_s = 2.0 * pi  # natural frequency of the joints on their springs
RATIO = 0.7
GRAVITY_IN_s = 0.12  # the weight's torque comes within half a second, steepest in the middle
LEAST_RATE_per_s = 1000.0  # N m/s or N/s; without a key of robot.yaml the gate allows no more
SPARE = 2.0  # torque, as a multiple of what the weight needs
ROTOR_kgm2_per_Nm = 4e-4  # reflected rotor inertia per peak torque; that of common geared drives
PEAK_A = 30.0  # current at peak torque
WINDING_ohm = 0.3
KP_MOST_Nm_per_rad, KD_MOST_Nms_per_rad = 5000.0, 500.0  # if the drives carry so much


def three(value: float) -> float:
    """Three significant digits."""
    return float(f"{value:.3g}")


def number(value: float, digits: int = 6) -> str:
    """As every YAML reader takes it: 4.0e-05, as 4e-05 is text to some."""
    text = f"{value:.{digits}g}"
    return text.replace("e", ".0e") if "e" in text and "." not in text else text


@dataclass(frozen=True)
class JointGuess:
    """`ignores`: the URDF's limits are placeholders or too low; these count instead."""

    facts: JointFacts
    motor: str
    low: float
    high: float
    velocity: float
    torque: float
    ignores: bool
    K_q: float
    D_null: float
    hold_kp: float
    hold_kd: float

    @property
    def torque_rate(self) -> float | None:
        """If carrying a heavy arm needs more than the default."""
        needed = three(self.facts.gravity / GRAVITY_IN_s)
        return needed if needed > LEAST_RATE_per_s else None


@dataclass(frozen=True)
class MotorGuess:
    """Of all joints with the same torque, velocity and settings of the motor. Torque at the joint,
    the rest before the gear; `kp`, `kd`: the largest holding gains of its joints.
    """

    name: str
    wired: Motor
    slides: bool
    peak: float
    velocity: float
    gear: float
    rotor: float
    constant: float
    kp: float
    kd: float


@dataclass(frozen=True)
class Guesses:
    joints: list[JointGuess]
    motors: list[MotorGuess]
    K_x: float
    K_rotation: float


def guess(arm: ArmFacts, wired: list[Motor]) -> Guesses:
    """`wired`: the motor of each joint."""
    names: dict[tuple, str] = {}
    joints = [_joint(facts, motor, names) for facts, motor in zip(arm.joints, wired, strict=True)]
    motors = [
        _motor(name, [one for one in zip(joints, wired, strict=True) if one[0].motor == name])
        for name in names.values()
    ]
    K_x = three(float(np.clip(10.0 * arm.mass_kg, 5.0, 1000.0)))
    return Guesses(joints, motors, K_x, three(0.05 * K_x) if len(joints) >= 6 else 0.0)


def _joint(facts: JointFacts, wired: Motor, names: dict[tuple, str]) -> JointGuess:
    weak = facts.effort < 1.2 * facts.gravity_home
    needed = three(max(SPARE * facts.gravity, 20.0 * facts.inertia, 0.5))
    torque = facts.effort if isfinite(facts.effort) and not weak else needed
    velocity = facts.velocity if isfinite(facts.velocity) else (0.3 if facts.slides else 2.0)
    torque = min(torque, wired.most("torque_Nm"))
    velocity = min(velocity, wired.most("velocity_rad_per_s"))
    turns = facts.kind == "continuous"
    low, high = facts.low, facts.high
    if not turns and not isfinite(high - low):
        low, high = (-0.2, 0.2) if facts.slides else (-3.0, 3.0)
    carried = wired.most("position_rad")
    if isfinite(carried) and not facts.slides:
        most = 2.0 * pi if turns else carried
        low, high = max(low, -three(most)), min(high, three(most))
    inertia = facts.inertia + ROTOR_kgm2_per_Nm * torque
    K_q = three(min(SOFT_rad_per_s**2 * inertia, 1e4))
    kp = three(min(4.0 * K_q, wired.most("kp_Nm_per_rad"), KP_MOST_Nm_per_rad))
    kd = 2.0 * RATIO * sqrt(kp * inertia)
    kd = three(min(kd, wired.most("kd_Nms_per_rad"), KD_MOST_Nms_per_rad))
    stored = tuple((key, value) for key, value in wired.keys.items() if key.startswith("motors."))
    key = (facts.slides, torque, velocity, wired.drives.word, stored)
    limits = (facts.effort, facts.velocity) if turns else (facts.effort, facts.velocity, facts.high)
    return JointGuess(
        facts,
        names.setdefault(key, f"motor_{len(names) + 1}"),
        low,
        high,
        velocity,
        torque,
        weak or not all(isfinite(limit) for limit in limits),
        K_q,
        three(0.6 * sqrt(K_q * inertia)),
        kp,
        kd,
    )


def _motor(name: str, joints: list[tuple[JointGuess, Motor]]) -> MotorGuess:
    first, wired = joints[0]
    peak = first.torque
    read = wired.key("motors.*", "gear_ratio")
    gear = float(read[1]) if read else wired.drives.usual_gear_ratio
    return MotorGuess(
        name,
        wired,
        first.facts.slides,
        peak,
        first.velocity,
        gear,
        three(ROTOR_kgm2_per_Nm * peak / gear**2),
        three(peak / (PEAK_A * gear)),
        max(joint.hold_kp for joint, _ in joints),
        max(joint.hold_kd for joint, _ in joints),
    )
