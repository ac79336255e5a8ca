"""When a limit on the rate of the torque begins to change what is asked for."""

import math

import numpy as np

from limber_lecture.context import Comparison, Context, case
from limber_lecture.pictures import BLACK, BLUE, MEASURED, ORANGE, name_axes, note
from limber_lecture.search import limit_by_combs

TITLE = "A rate limit leaves small and slow torques alone and turns large fast ones into triangles"
CLAIM = "What an actuator cannot do is not noticed until a law asks for it: here a rate of torque"
SECTION = "3.1"
PLANT = "the controller's torque limiter at 1 kHz, fed with sines"
FAST = True

T, RATE, TAU_MAX = 1e-3, 400.0, 50.0  # s, N m/s, N m
FREQUENCIES_HZ = (2.03, 5.07, 20.3)


def onset(f: float) -> float:
    """R T/(2 sin(ωT/2)): the greatest change of a sampled sine in one sample is the limit."""
    return RATE * T / (2 * math.sin(math.pi * f * T))


def run(context: Context) -> list[Comparison]:
    checks = []
    for f in FREQUENCIES_HZ:
        name = f"{f:g} Hz passes unchanged up to"
        checks.append(Comparison(name, onset(f), transparent_up_to(context, f), "N m", 0.002))
    for f in (10.0, 25.0):
        _, out = limited(context, f, [10 * onset(f)])
        settled = out[0][len(out[0]) // 2 :]
        amplitude = (settled.max() - settled.min()) / 2
        name = f"triangle left of a large sine of {f:g} Hz"
        checks.append(Comparison(name, RATE / (4 * f), amplitude, "N m", 0.01))
    checks.append(saturated(context))
    draw(context)
    return checks


def limited(
    context: Context, f: float, amplitudes: list[float], ceiling: float = 1e6
) -> tuple[np.ndarray, list[np.ndarray]]:
    """What was asked, for amplitude 1, and what comes out for each amplitude."""
    t = np.arange(0.0, max(1.0, 3.0 / f), T)
    asked = np.sin(2 * math.pi * f * t)
    limits = {"tau0": 0.0, "tau_max": ceiling, "rate_max": RATE, "T": T}
    answers = context.eval([case("limit_seq", tau=a * asked, **limits) for a in amplitudes])
    return asked, [np.ravel(answer["tau"]) for answer in answers]


def transparent_up_to(context: Context, f: float) -> float:
    """Largest amplitude that comes out as it went in."""

    def pass_through(amplitudes: np.ndarray) -> list[bool]:
        asked, outs = limited(context, f, list(amplitudes))
        pairs = zip(amplitudes, outs, strict=True)
        return [np.max(np.abs(out - a * asked)) < 1e-9 * a for a, out in pairs]

    return limit_by_combs(pass_through, 0.5 * onset(f), 2.0 * onset(f), 8)


def saturated(context: Context) -> Comparison:
    """A slow sine beyond the ceiling is cut at it."""
    _, (out,) = limited(context, 0.5, [80.0], TAU_MAX)
    return Comparison("greatest torque sent", TAU_MAX, np.abs(out).max(), "N m", 1e-9)


def draw(context: Context) -> None:
    f = 5.0
    with context.picture(TITLE, columns=2, size=(12.5, 5.0)) as (left, right):
        asked, outs = limited(context, f, [0.9 * onset(f), 4 * onset(f)])
        t_ms = np.arange(len(asked)) * T * 1e3
        window = slice(600, 1000)
        for out, scale, color, name in (
            (outs[0], 0.9, BLUE, "just below the onset: unchanged"),
            (outs[1], 4.0, ORANGE, "four times the onset: a late triangle"),
        ):
            left.plot(t_ms[window] - 600, out[window], color=color, label=name)
            left.plot(t_ms[window] - 600, scale * onset(f) * asked[window], ":", color=color)
        left.plot([], [], ":", color=BLACK, label="asked for")
        left.set_title("Two sines of 5 Hz, limit 400 N m/s")
        left.set_ylim(-60, 90)
        name_axes(left, "time (ms)", "torque (N m)", "upper right")
        frequencies = np.geomspace(1, 100, 50)
        bound = [onset(f) for f in frequencies]
        right.loglog(frequencies, bound, color=BLUE, label="onset: RT/(2 sin(ωT/2))")
        some = [1.5, 3.1, 7.3, 15.1, 40.7]
        largest, words = [transparent_up_to(context, f) for f in some], "largest sine that passes"
        right.loglog(some, largest, **MEASURED, color=BLUE, label=f"{words} unchanged")
        right.fill_between(frequencies, 0.5, bound, color=BLUE, alpha=0.12, lw=0)
        note(right, "passes unchanged", (2.2, 2.0), color=BLACK)
        right.set_ylim(0.5, 100)
        name_axes(right, "frequency (Hz)", "amplitude of the torque (N m)", "upper right")
