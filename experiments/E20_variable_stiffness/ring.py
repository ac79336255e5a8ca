"""A joint between two tendons is let go: nothing but its bearing damps it."""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from limber.experiments import testbench as bench
from limber.experiments.check import Check
from limber.experiments.context import Context
from limber.experiments.ringdown import Mode, modes_seen
from limber.experiments.testbench import M
from limber.experiments.truth import seconds

from .pair import K_2, torque

D = 0.05  # N m s/rad, of the link's bearing
SIGMA = 120.0  # N m/rad
C = SIGMA / (2 * K_2)  # preload, rad
# In reality, whatever the motors are told: 1e6 kg m² behind the gear
CLAMPED = bench.motor(
    rotor_inertia_kgm2=1.0, gear_ratio=1000.0, rotor_torque_constant_Nm_per_A=1e-3
)
START_RAD, RING_S, EVERY = 0.05, 6.0, 20
START_S, PUSH_S, HELD_S = 2.0, 1.5, 0.1


@dataclass(frozen=True)
class Rung:
    t: np.ndarray
    q: np.ndarray
    mode: Mode


def ideal() -> Rung:
    """Both motors stand still; the springs as they are, slack included."""

    def rate(_: float, x: np.ndarray) -> np.ndarray:
        return np.array([x[1], (torque(C, C, x[0]) - D * x[1]) / M])

    t = np.arange(0, RING_S, 1e-3)
    q, v = solve_ivp(rate, (0, RING_S), [START_RAD, 0.0], t_eval=t, rtol=1e-9, atol=1e-12).y
    return Rung(t, q, _mode(q, v))


def bus(context: Context) -> Rung:
    """The bench with two motors, clamped; pushed and let go, by its link encoder."""
    transmission = {
        "kind": "antagonistic",
        "spring": {"law": "quadratic", "k2_Nm_per_rad2": K_2, "stiffness_Nm_per_rad": None},
        "damping_Nms_per_rad": 0.0,
        "preload_rad": C,
        "preload_max_rad": 0.4,
    }
    changes = bench.joint(
        transmission=transmission,
        antagonist={"id": 2},
        torque_loop=None,
        link_friction={"coulomb_Nm": 0.0, "viscous_Nms_per_rad": D},
    )
    let_go = START_S + PUSH_S
    held = let_go - HELD_S
    pull = START_RAD * SIGMA
    log = bench.on_bus(
        context,
        "ring",
        {"law": "gravity_compensation"},
        # up slowly, so that the joint does not ring yet; the second push ends at once
        [bench.push(pull, START_S, 3 * PUSH_S, PUSH_S - HELD_S), bench.push(pull, held, HELD_S)],
        let_go + RING_S,
        changes=changes,
        reality=CLAMPED,
    )
    rows = log.read("JOINT_STATE")
    t = seconds(rows) - let_go
    during = (t > 0.01) & (t < RING_S)
    q, v = rows["q"][during, 0], rows["v"][during, 0]
    return Rung(t[during], q, _mode(q, v))


def _mode(q: np.ndarray, v: np.ndarray) -> Mode:
    return modes_seen([np.column_stack([q, v])[::EVERY]], EVERY * 1e-3, 1)[0]


def found(context: Context) -> dict[str, Rung]:
    return {"ideal": ideal(), "bus": bus(context)}


def checks(rung: dict[str, Rung]) -> list[Check]:
    made = []
    for where, run in rung.items():
        name = f"both motors clamped, let go, {where}"
        omega, zeta = np.sqrt(SIGMA / M), D / (2 * np.sqrt(SIGMA * M))
        made.append(Check(f"{name}: frequency", omega, run.mode.omega, "rad/s", 0.01))
        made.append(Check(f"{name}: damping ratio", zeta, run.mode.zeta, "", 0.03))
    return made
