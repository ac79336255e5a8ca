"""Does an arm on a virtual spring ever gain energy by itself?"""

from typing import Any

from limber.experiments.check import Check
from limber.experiments.context import Context
from limber.experiments.pictures import BLUE, GREEN, MEASURED, ORANGE

from .runs import RATES_HZ, ZETA, Fall, K, fall, fed_in

TITLE = "Let go far from its goal, the arm only loses energy; delay alone would feed some in"
CLAIM = (
    "An arm behind a virtual spring and damper stays passive without cancelling Coriolis torques"
)
SECTION = "2"
PLANT = "ideal7 at 1 and 2 kHz, exact equations, cartesian_impedance with gravity alone"
FAST = False
RISE_J = 5e-3


def run(context: Context) -> list[Check]:
    damped = {rate: fall(context, rate, damped=True) for rate in RATES_HZ}
    undamped = {rate: fall(context, rate, damped=False) for rate in RATES_HZ}
    with context.picture(TITLE, columns=2, size=(12.5, 5.0)) as (left, right):
        draw_fall(damped[RATES_HZ[0]], left)
        draw_gain(undamped, right)
    checks = []
    for rate, run in damped.items():
        name = f"let go at {rate} Hz: energy rises by at most"
        checks.append(Check(name, 0.0, run.risen, "J", RISE_J, "at_most"))
        name = f"let go at {rate} Hz: distance at the start"
        checks.append(Check(name, 0.15, run.distance, "m", 0.0, "at_least"))
        name = f"let go at {rate} Hz: share of the energy left"
        checks.append(Check(name, 0.0, float(run.total[-1] / run.total[0]), "", 1e-2, "at_most"))
    for rate, run in undamped.items():
        gain = float(run.total[-1] - run.total[0])
        name = f"without damping at {rate} Hz: fed in by the delay"
        checks.append(Check(name, float(fed_in(run, rate)[-1]), gain, "J", 0.02))
    return checks


def draw_fall(run: Fall, ax: Any) -> None:
    ax.stackplot(
        run.t, run.kinetic, run.spring, colors=(ORANGE, BLUE), alpha=0.5,
        labels=("kinetic energy of the arm", f"energy of the spring, {K[0]:.0f} N/m"),
    )  # fmt: skip
    ax.plot(run.t, run.total, color="black", label="both: never rises")
    ax.set_xlim(0, 1.2)
    ax.set_title(f"Let go {run.distance * 100:.0f} cm from the goal, damping ratio {ZETA:g}")
    ax.set_xlabel("time since it was let go (s)")
    ax.set_ylabel("energy (J)")
    ax.legend()


def draw_gain(runs: dict[int, Fall], ax: Any) -> None:
    for (rate, run), color in zip(runs.items(), (ORANGE, GREEN), strict=True):
        gain = (run.total - run.total[0]) * 1e3
        few = slice(None, None, rate // 50)
        ms = run.t * 1e3
        ax.plot(
            ms, fed_in(run, rate) * 1e3, color=color, label=f"{rate} Hz: t ∫vᵀ(∂²U/∂q² - ∂g/∂q)v dt"
        )
        ax.plot(ms[few], gain[few], **MEASURED, color=color)
    ax.plot([], [], **MEASURED, color="0.3", label="measured")
    ax.set_title("The same without any damping: delay feeds energy in")
    ax.set_xlabel("time since it was let go (ms)")
    ax.set_ylabel("energy gained (mJ)")
    ax.legend()
