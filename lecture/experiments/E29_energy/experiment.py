"""Does an arm on a virtual spring ever gain energy by itself?"""

from limber_lecture.context import Comparison, Context, at_least, at_most
from limber_lecture.pictures import BLUE, GREEN, MEASURED, ORANGE, Axes, name_axes

from .runs import RATES_HZ, ZETA, Fall, K, fall, fed_in

TITLE = "Let go far from its goal, the arm only loses energy; delay alone would feed some in"
CLAIM = "An arm behind a virtual spring and damper stays passive without cancelling Coriolis"
CLAIM += " torques"
SECTION = "2"
PLANT = "ideal7 at 1 and 0.5 kHz, exact equations, cartesian_impedance with gravity alone"
FAST = False
RISE_J = 5e-3


def run(context: Context) -> list[Comparison]:
    damped = {rate: fall(context, rate, damped=True) for rate in RATES_HZ}
    undamped = {rate: fall(context, rate, damped=False) for rate in RATES_HZ}
    with context.picture(TITLE, columns=2, size=(12.5, 5.0)) as (left, right):
        draw_fall(damped[RATES_HZ[0]], left)
        draw_gain(undamped, right)
    checks = []
    for rate, run in damped.items():
        name, left = f"let go at {rate} Hz", run.total[-1] / run.total[0]
        checks += [
            at_most(f"{name}: energy rises by at most", 0.0, run.risen, "J", RISE_J),
            at_least(f"{name}: distance at the start", 0.15, run.distance, "m"),
            at_most(f"{name}: share of the energy left", 0.0, left, margin=1e-2),
        ]
    for rate, run in undamped.items():
        fed, gain = fed_in(run, rate)[-1], run.total[-1] - run.total[0]
        name = f"without damping at {rate} Hz: fed in by the delay"
        checks.append(Comparison(name, fed, gain, "J", 0.02))
    return checks


def draw_fall(run: Fall, ax: Axes) -> None:
    names = ("kinetic energy of the arm", f"energy of the spring, {K[0]:.0f} N/m")
    ax.stackplot(run.t, run.kinetic, run.spring, colors=(ORANGE, BLUE), alpha=0.5, labels=names)
    ax.plot(run.t, run.total, color="black", label="both: never rises")
    ax.set_xlim(0, 1.2)
    ax.set_title(f"Let go {run.distance * 100:.0f} cm from the goal, damping ratio {ZETA:g}")
    name_axes(ax, "time since it was let go (s)", "energy (J)", "best")


def draw_gain(runs: dict[int, Fall], ax: Axes) -> None:
    for (rate, run), color in zip(runs.items(), (ORANGE, GREEN), strict=True):
        gain = (run.total - run.total[0]) * 1e3
        few = slice(None, None, rate // 50)
        ms = run.t * 1e3
        formula = f"{rate} Hz: t ∫vᵀ(∂²U/∂q² - ∂g/∂q)v dt"
        ax.plot(ms, fed_in(run, rate) * 1e3, color=color, label=formula)
        ax.plot(ms[few], gain[few], **MEASURED, color=color)
    ax.plot([], [], **MEASURED, color="0.3", label="measured")
    ax.set_title("The same without any damping: delay feeds energy in")
    name_axes(ax, "time since it was let go (ms)", "energy gained (mJ)", "best")
