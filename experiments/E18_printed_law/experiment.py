"""The lecture's motor law as it is printed: it has no set-point."""

from typing import Any

import numpy as np

from limber.experiments import testbench as bench
from limber.experiments.check import Check
from limber.experiments.context import Context
from limber.experiments.evaluate import case
from limber.experiments.pictures import BLUE, GREEN, MEASURED, ORANGE

from . import joint

TITLE = "The motor law as printed makes the rotor light, and lets the arm fall"
CLAIM = "A high gain on the difference of motor and joint angle controls the arm"
SECTION = "3.2"
PLANT = "link of 0.5 and rotor of 0.2 kg m² on a spring of 60 N m/rad: its equations (ideal), and"
PLANT += " the test bench on its bus"
FAST = True

GAINS = (0.0, 60.0, 240.0)  # N m/rad
FALLING = 240.0


def run(context: Context) -> list[Check]:
    ideal = [joint.acceleration_model(K_pm) for K_pm in GAINS]
    bus = [joint.pushed_bus(context, K_pm) for K_pm in GAINS]
    height, time, t, q = joint.fall_bus(context, FALLING)
    with context.picture(TITLE, columns=2, size=(13.5, 5.2)) as (left, right):
        draw_push(ideal, bus, left)
        draw_fall(t, q, right)
    return [*pushes(ideal, bus), *fall(height, time, q), *by_controller(context)]


def pushes(ideal: list[float], bus: list[float]) -> list[Check]:
    made = []
    for K_pm, model, seen in zip(GAINS, ideal, bus, strict=True):
        wanted = joint.PUSH_NM / joint.inertia(K_pm)
        name = f"acceleration by 1 N m, K_pm = {K_pm:g} N m/rad"
        made.append(Check(f"{name}, ideal", wanted, model, "rad/s²", 0.005))
        made.append(Check(f"{name}, bus", wanted, seen, "rad/s²", 0.005))
    return made


def fall(height: float, time: float, q: np.ndarray) -> list[Check]:
    """From where it turned by itself: rest is nowhere but below."""
    wanted = joint.fall_time(FALLING, height)
    name = f"falls from {height:.2f} rad to where it hangs in"
    model = joint.fall_time_model(FALLING, height)
    return [
        Check(f"{name}, ideal", wanted, model, "s", 0.005),
        Check(f"{name}, bus", wanted, time, "s", 0.005),
        Check("lowest angle of an arm held at 2 rad, bus", 0.0, float(q.min()), "rad", 0.0,
              "at_most"),
    ]  # fmt: skip


def by_controller(context: Context) -> list[Check]:
    """The controller's class at random states."""
    states = context.rng.uniform(-1, 1, (20, 4))
    K_vm = joint.damper(FALLING)
    K = {"Kpm": [[FALLING]], "Kvm": [[K_vm]]}
    cases = [
        case("deflection_pd", q=[q], v=[v], theta=[theta], thetad=[theta_dot], **K)
        for q, v, theta, theta_dot in states
    ]
    found = np.array([np.ravel(answer["tau_m"])[0] for answer in context.eval(cases)])
    by_hand = states @ [FALLING, K_vm, -FALLING, -K_vm]
    off = float(np.abs(found - by_hand).max())
    name = "law of the controller and the equation differ by"
    return [Check(name, 0.0, off, "N m", 1e-9, "absolute")]


def draw_push(ideal: list[float], bus: list[float], ax: Any) -> None:
    gains = np.linspace(0, 260, 100)
    line = [joint.PUSH_NM / joint.inertia(K) for K in gains]
    ax.plot(gains, line, color=BLUE, label="1 N m / (M + B/(1 + K/K_J))")
    ax.plot(GAINS, ideal, **bench.IDEAL, color=BLUE, label="on the joint's equations")
    ax.plot(GAINS, bus, **MEASURED, color=BLUE, label="measured on the bus")
    for value, name in ((bench.M + bench.B, "link and rotor"), (bench.M, "link alone")):
        ax.axhline(1 / value, color="0.5", ls=":", lw=1)
        ax.annotate(name, (258, 1 / value - 0.005), ha="right", va="top", color="0.35")
    ax.set_title("Pushed by 1 N m, weightless")
    ax.set_xlabel("gain of the law, K_pm (N m/rad)")
    ax.set_ylabel("acceleration of the link (rad/s²)")
    ax.legend(loc="lower right", bbox_to_anchor=(1.0, 0.08))


def draw_fall(t: np.ndarray, q: np.ndarray, ax: Any) -> None:
    ax.plot(t, q, color=ORANGE, label="measured on the bus")
    ax.axhline(joint.START, color=GREEN, ls="--", lw=1.2, label="where it was held")
    ax.axhline(0, color="0.5", ls=":", lw=1)
    ax.annotate("hanging", (-0.28, 0.06), color="0.35")
    ax.set_xlim(-0.3, t[-1])
    ax.axvline(0, color="0.5", ls=":", lw=1)
    ax.annotate("the law begins", (0.03, -2.3), color="0.35")
    ax.set_ylim(-2.6, 2.9)
    ax.set_title("Under gravity: nothing holds the arm")
    ax.set_xlabel("time since the law began (s)")
    ax.set_ylabel("angle of the link from hanging (rad)")
    ax.legend(loc="upper right")
