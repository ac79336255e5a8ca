"""A joint between two tendons is let go: nothing but its bearing damps it."""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from limber_lecture import testbench as bench
from limber_lecture.context import Comparison, Context, at_most
from limber_lecture.elastic import State, one_joint, run
from limber_lecture.ringdown import Mode, mode_seen
from limber_lecture.testbench import B, M
from limber_lecture.variants import friction

from .pair import K_2, torque

D = 0.05  # N m s/rad, of the link's bearing
SIGMA = 120.0  # N m/rad
C = SIGMA / (2 * K_2)  # preload, rad
SERVO, LEAD_S = 50.0, 3e-3  # rad/s, s: of the law that places the motors
PLACED = {"law": "variable_stiffness", "stiffness_fit": "joint", "K_q_Nm_per_rad": SIGMA}
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
    return Rung(t, q, mode_seen(q, v, EVERY))


def ideal_under_law() -> Rung:
    """e = (θ₁ - θ₂)/2 has both rotors' inertia: τ = σ (1 + T d/dt)(e - q) - 2B (w² e + 2 w ė)."""
    arm = one_joint(M, 2 * B, SIGMA, 0.0, link_damping=D)

    def law(t: float, x: State) -> np.ndarray:
        spring = SIGMA * (x.theta - x.q + LEAD_S * (x.theta_dot - x.v))
        return spring - 2 * B * (SERVO**2 * x.theta + 2 * SERVO * x.theta_dot)

    start = State(*(np.array([value]) for value in (START_RAD, 0.0, 0.0, 0.0)))
    track = run(arm, law, RING_S, start=start)
    return Rung(track.t, track.x.q[:, 0], mode_seen(track.x.q[:, 0], track.x.v[:, 0], EVERY))


def bus(context: Context, clamped: bool) -> Rung:
    """The bench with two motors; pushed and let go, by its link encoder."""
    transmission = {
        "kind": "antagonistic",
        "spring": {"law": "quadratic", "k2_Nm_per_rad2": K_2, "stiffness_Nm_per_rad": None},
        "damping_Nms_per_rad": 0.0,
        "preload_rad": C,
        "preload_max_rad": 0.4,
    }
    two = {"transmission": transmission, "antagonist": {"id": 2}, "torque_loop": None}
    changes = bench.joint(**two, link_friction=friction(viscous=D))
    let_go, pull = START_S + PUSH_S, START_RAD * SIGMA
    # up slowly, so that the joint does not ring yet; the second push ends at once
    up = bench.push(pull, START_S, 3 * PUSH_S, PUSH_S - HELD_S)
    held = bench.push(pull, let_go - HELD_S, HELD_S)
    law, plant_overrides = (bench.FREE, bench.CLAMPED) if clamped else (PLACED, {})
    name, end = "clamped" if clamped else "under_law", let_go + RING_S
    robot = {"changes": changes, "plant_overrides": plant_overrides}
    log = bench.on_bus(context, name, law, [up, held], end, **robot)
    seen = bench.sensed(log, let_go + 0.01, end)
    return Rung(seen["t"] - let_go, seen["q"], mode_seen(seen["q"], seen["v"], EVERY))


def found(context: Context) -> dict[str, Rung]:
    return {"ideal": ideal(), "bus": bus(context, True)}


def found_under_law(context: Context) -> dict[str, Rung]:
    return {"ideal": ideal_under_law(), "bus": bus(context, False)}


def checks(rung: dict[str, Rung]) -> list[Comparison]:
    made = []
    for where, seen in rung.items():
        name = f"both motors clamped, let go, {where}"
        omega, zeta = np.sqrt(SIGMA / M), D / (2 * np.sqrt(SIGMA * M))
        made.append(Comparison(f"{name}: frequency", omega, seen.mode.omega, "rad/s", 0.01))
        made.append(Comparison(f"{name}: damping ratio", zeta, seen.mode.zeta, "", 0.03))
    return made


def checks_under_law(rung: dict[str, Rung]) -> list[Comparison]:
    """What delay and the law's lead add is no damping to speak of."""
    model, seen = rung["ideal"].mode, rung["bus"].mode
    name = "motors placed by the law, let go, bus"
    ideal = f"{name} (prediction: ideal)"
    return [
        Comparison(f"{ideal}: frequency", model.omega, seen.omega, "rad/s", 0.01),
        Comparison(f"{ideal}: damping ratio", model.zeta, seen.zeta, "", 0.05),
        at_most(f"{name}: damping ratio", 0.01, seen.zeta),
    ]
