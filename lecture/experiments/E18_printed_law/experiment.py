"""The lecture's motor law as it is printed: it has no set-point."""

import numpy as np

from limber_lecture import testbench as bench
from limber_lecture.context import Comparison, Context, at_most, case, ideal_and_bus, near_zero
from limber_lecture.pictures import BLUE, GREEN, ORANGE, Axes, level, name_axes, plot_marks

from . import joint

TITLE = "The motor law as printed makes the rotor light, and lets the arm fall"
CLAIM = "A high gain on the difference of motor and joint angle controls the arm"
SECTION = "3.2"
PLANT = "link of 0.5 and rotor of 0.2 kg m² on a spring of 60 N m/rad: its equations (ideal), and"
PLANT += " the test bench on its bus"
FAST = True

GAINS = (0.0, 60.0, 240.0)  # N m/rad
FALLING = 240.0


def run(context: Context) -> list[Comparison]:
    ideal = [joint.acceleration_model(K_pm) for K_pm in GAINS]
    bus = [joint.pushed_bus(context, K_pm) for K_pm in GAINS]
    height, time, t, q = joint.fall_bus(context, FALLING)
    with context.picture(TITLE, columns=2, size=(13.5, 5.2)) as (left, right):
        draw_push(ideal, bus, left)
        draw_fall(t, q, right)
    return [*pushes(ideal, bus), *fall(height, time, q), *by_controller(context)]


def pushes(ideal: list[float], bus: list[float]) -> list[Comparison]:
    made = []
    for K_pm, model, seen in zip(GAINS, ideal, bus, strict=True):
        wanted = joint.PUSH_NM / joint.inertia(K_pm)
        name = f"acceleration by 1 N m, K_pm = {K_pm:g} N m/rad"
        made += ideal_and_bus(name, wanted, model, seen, "rad/s²", 0.005)
    return made


def fall(height: float, time: float, q: np.ndarray) -> list[Comparison]:
    """From where it turned by itself: rest is nowhere but below."""
    wanted = joint.fall_time(FALLING, height)
    name = f"falls from {height:.2f} rad to where it hangs in"
    model = joint.fall_time_model(FALLING, height)
    return [
        *ideal_and_bus(name, wanted, model, time, "s", 0.005),
        at_most("lowest angle of an arm held at 2 rad, bus", 0.0, q.min(), "rad"),
    ]


def by_controller(context: Context) -> list[Comparison]:
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
    name = "law of the controller and the equation differ by"
    return [near_zero(name, np.abs(found - by_hand).max(), "N m", 1e-9)]


def draw_push(ideal: list[float], bus: list[float], ax: Axes) -> None:
    gains = np.linspace(0, 260, 100)
    line = [joint.PUSH_NM / joint.inertia(K) for K in gains]
    ax.plot(gains, line, color=BLUE, label="1 N m / (M + B/(1 + K/K_J))")
    plot_marks(ax, GAINS, ideal, bus, color=BLUE)
    for value, name in ((bench.M + bench.B, "link and rotor"), (bench.M, "link alone")):
        level(ax, name, (258, 1 / value), (0, -3), ha="right", va="top")
    ax.set_title("Pushed by 1 N m, weightless")
    name_axes(ax, "gain of the law, K_pm (N m/rad)", "acceleration of the link (rad/s²)")
    ax.legend(loc="lower right", bbox_to_anchor=(1.0, 0.08))


def draw_fall(t: np.ndarray, q: np.ndarray, ax: Axes) -> None:
    ax.plot(t, q, color=ORANGE, label="measured on the bus")
    ax.axhline(joint.START, color=GREEN, ls="--", lw=1.2, label="where it was held")
    ax.set_xlim(-0.3, t[-1])
    level(ax, "hanging", (-0.28, 0), (0, 3))
    level(ax, "the law begins", (0, -2.3), (3, 0), upright=True)
    ax.set_ylim(-2.6, 2.9)
    ax.set_title("Under gravity: nothing holds the arm")
    name_axes(
        ax, "time since the law began (s)", "angle of the link from hanging (rad)", "upper right"
    )
