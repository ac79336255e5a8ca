"""The test bench robots/testbench, one joint: its figures, its equations, and runs on its bus.

Equations are linear, (A, B) of ẋ = A x + B u with the inputs motor torque and push; sampled ones
are exact (plants.held).
"""

from itertools import pairwise
from typing import Any

import numpy as np

from limber.arrays import Floats
from limber.errors import RunError
from limber.log.reader import Log, time_s
from limber.paths import robot_folder
from limber.yaml_file import read_yaml
from limber_lecture.context import Context
from limber_lecture.plants import held, with_delay
from limber_lecture.ringdown import Mode
from limber_lecture.timeline import joint_damping
from limber_lecture.truth import RAMP, between, motion, status
from limber_lecture.variants import variant

ROBOT = "testbench"
JOINT, MOTOR = "joint", "bench"
M, B = 0.5, 0.2  # kg m², link and rotor
K_J, D_J = 5000.0, 2.0  # N m/rad, N m s/rad, of the spring between them
CYCLE_S = 1e-3  # a torque computed from one sample acts from the next one on, and is held
LINK_MASS_M = 1.0  # kg m, the link's mass times the way to its centre
SETTLED_S = 1.6  # the law of the run, which begins at GAINS_S, has settled
FREE = {"law": "gravity_compensation"}  # no torque at all: the bench lies
FAST_KGM2 = 1e6  # a rotor or link of this inertia, behind the gear, stays where it is

Plant = tuple[Floats, Floats]


def weight(q: float, gravity: float) -> float:
    """Torque that holds the link; it hangs at zero."""
    torque: float = LINK_MASS_M * gravity * np.sin(q)
    return torque


def rigid(inertia: float, damping: float = 0.0) -> Plant:
    """Link and rotor as one; state (q, q̇)."""
    A = np.array([[0.0, 1.0], [0.0, -damping / inertia]])
    return A, np.array([[0.0, 0.0], [1 / inertia, 1 / inertia]])


def lagging(plant: Plant, lag: float) -> Plant:
    """The motor torque comes through a first-order lag: one state more, behind the others."""
    A, inputs = plant
    n = len(A)
    A_all, B_all = np.zeros((n + 1, n + 1)), np.zeros((n + 1, 2))
    A_all[:n, :n], A_all[:n, n], A_all[n, n] = A, inputs[:, 0], -1 / lag
    B_all[:n, 1], B_all[n, 0] = inputs[:, 1], 1 / lag
    return A_all, B_all


def elastic(spring: float = K_J, damper: float = D_J, link: float = M, rotor: float = B) -> Plant:
    """State (q, q̇, θ, θ̇); the push is on the link."""
    pull = np.array([-spring, -damper, spring, damper])
    A = np.vstack([[0, 1, 0, 0], pull / link, [0, 0, 0, 1], -pull / rotor])
    return A, np.array([[0.0, 0.0], [0.0, 1 / link], [0.0, 0.0], [1 / rotor, 0.0]])


def held_link(spring: float = K_J, damper: float = D_J, rotor: float = B) -> Plant:
    """State (θ, θ̇): the link does not move."""
    A = np.array([[0.0, 1.0], [-spring / rotor, -damper / rotor]])
    return A, np.array([[0.0, 0.0], [1 / rotor, 0.0]])


def looped(plant: Plant, gains: list[float], T: float, late: int) -> Floats:
    """One sample of the loop τ_m = -gains x, held over T, `late` samples after it was measured."""
    A, inputs = plant
    A, inputs = with_delay(*held(A, inputs[:, :1], T), late)
    return A - inputs @ _row(gains, len(A))


def _row(gains: list[float], size: int) -> Floats:
    return np.pad(gains, (0, size - len(gains)))[None]


def slowest(loop: Floats, T: float) -> Mode:
    """The mode of a sampled loop that dies out last of those that swing."""
    steps = np.linalg.eigvals(loop).astype(complex)
    roots = np.log(steps[abs(steps) > 1e-9]) / T  # 0: a state that is forgotten at once
    s = max((s for s in roots if s.imag > 1e-3 * abs(s)), key=lambda s: s.real)
    return Mode.of(s)


def at_rest(plant: Plant, gains: list[float], push: float) -> Floats:
    """State that the loop under a constant push comes to: (A - B gains) x + B_push push = 0."""
    A, inputs = plant
    return np.linalg.solve(A - inputs[:, :1] @ _row(gains, len(A)), -inputs[:, 1] * push)


def zero_between(values: list[float], rates: list[float]) -> float:
    """Where a rate measured at some values passes zero, on the line between two of them."""
    for (a, x), (b, y) in pairwise(zip(values, rates, strict=True)):
        if x * y <= 0:
            return a - x * (b - a) / (y - x)
    raise RunError(f"{rates} at {values}: no zero between them")


def spring_damper(K: float, D: float, **more: Any) -> dict[str, Any]:
    """Gains of the joint PD law."""
    return {"law": "joint_pd", **given(K, D), **more}


def given(K: float, D: float) -> dict[str, Any]:
    return {"K_q_Nm_per_rad": K, **joint_damping(D)}


def push(torque: float, at_s: float, for_s: float, ramp_s: float = 0.0) -> dict[str, Any]:
    """On the link."""
    wrench = {"torque_Nm": [0.0, 0.0, torque], "for_s": for_s, "ramp_s": ramp_s}
    return {"at_s": at_s, "push": wrench}


def on_bus(
    context: Context,
    name: str,
    gains: dict[str, Any],
    more: list[dict[str, Any]],
    end_s: float,
    *,
    changes: dict[str, Any] | None = None,
    **head: Any,
) -> Log:
    """The bench under a law from 1 s on. `changes` to robot.yaml; `head` of the scenario."""
    robot = variant(context.out / name, ROBOT, changes or {})
    return context.run_law(name, robot, gains, more, end_s, **head)


def truth(log: Log, start_s: float, end_s: float) -> dict[str, Floats]:
    """What the joint really did while the law alone was at work."""
    status(log, start_s, end_s, RAMP)
    rows = motion(log, start_s, end_s)
    seen = {name: rows[name][:, 0] for name in ("q", "v", "theta", "theta_dot")}
    return {"t": time_s(rows), **seen, "tau": rows["tau_joint"][:, 0]}


def sensed(log: Log, start_s: float, end_s: float) -> dict[str, Floats]:
    """Link encoder, its velocity, and torque sensor, as they came over the bus."""
    rows = between(log, "JOINT_STATE", start_s, end_s)
    return {"t": time_s(rows), **{name: rows[name][:, 0] for name in ("q", "v", "tau")}}


def goal(log: Log, start_s: float, end_s: float) -> tuple[Floats, Floats]:
    """Times, and the angles that the law was to follow then."""
    rows = status(log, start_s, end_s, RAMP)
    w, z = rows["quat_BD"][:, 0], rows["quat_BD"][:, 3]
    return time_s(rows), np.unwrap(2 * np.arctan2(z, w))


def lag(log: Log, start_s: float, end_s: float, name: str = "q") -> float:
    """How far the joint is behind its goal, on average."""
    t, wanted = goal(log, start_s, end_s)
    seen = truth(log, start_s, end_s)
    return float((wanted - np.interp(t, seen["t"], seen[name])).mean())


def mean(log: Log, start_s: float, end_s: float, name: str = "q") -> float:
    """Rounded torques make a joint at rest tremble: where it is on average."""
    return float(truth(log, start_s, end_s)[name].mean())


RIGID = {
    "transmission": {"kind": "rigid", "spring": None, "damping_Nms_per_rad": None},
    "torque_loop": None,
}


def refused(log: Log) -> int:
    """Requests that the controller refused."""
    return int(log.read("CONTROLLER_STATUS")["requests_refused"].max())


def joint(**content: Any) -> dict[str, Any]:
    """A change of the bench's one joint."""
    return {"joints": {JOINT: content}}


def motor(**content: Any) -> dict[str, Any]:
    """A change of its motor."""
    return {"motors": {MOTOR: content}}


def gravity(g: float) -> dict[str, Any]:
    """A change of the bench: the link hangs down in this gravity, m/s²; 0: it lies."""
    return {"gravity_m_per_s2": [0.0, -g, 0.0]}


def sprung(K: float, D: float | None = None, **more: Any) -> dict[str, Any]:
    """A change of the bench's spring, damper, if it is given, and more of its joint."""
    damper = {} if D is None else {"damping_Nms_per_rad": D}
    return joint(transmission={"spring": {"stiffness_Nm_per_rad": K}, **damper}, **more)


def torque_constant(kappa: float) -> dict[str, Any]:
    """What robot.yaml does not know of the motor: the true value over the one that stands there."""
    return motor(
        rotor_torque_constant_Nm_per_A=kappa * motor_yaml()["rotor_torque_constant_Nm_per_A"]
    )


def motor_yaml() -> dict[str, Any]:
    found: dict[str, Any] = read_yaml(robot_folder(ROBOT) / "robot.yaml")["motors"][MOTOR]
    return found


# In plant_overrides, whatever the motor is told; its torque at the joint is as before
CLAMPED = motor(
    rotor_inertia_kgm2=1.0, gear_ratio=FAST_KGM2**0.5, rotor_torque_constant_Nm_per_A=1e-3
)
