"""Targets of a policy, late, irregular and in part lost: how the goal between them may be made."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes

from limber_lecture.context import Comparison, Context, at_most, case
from limber_lecture.pictures import BLACK, name_axes

TITLE = "Targets with times: the goal is smooth, late by no more than it must be, and soft"
CLAIM = "Targets at 30 Hz with jitter and loss become a goal as calm as the motion they sample"
SECTION = "2"
PLANT = "the goal alone, by the controller's own classes; for the contact one mass on its spring"
FAST = True

T, LENGTH_S, SETTLED = 1e-3, 24.0, slice(2000, 23000)
TRANSPORT_S, LOSS = 0.010, 0.10
# Peak speed 1 rad/s, peak acceleration about 4.8 rad/s², rms jerk about 14 rad/s³
HZ = np.array([0.13, 0.31, 0.57, 0.9, 1.6])
AMPLITUDE = np.array([0.3, 0.15, 0.08, 0.05, 0.016])
BOUNDS = {"v_fade": 1.0, "a_fade": 2.0, "v_max": 100.0, "a_max": 25.0}
MASS, STIFFNESS, RATIO, WALL = 3.0, 500.0, 0.7, 20000.0  # kg, N/m, -, N/m
REACH = 0.3  # m a radian


@dataclass(frozen=True)
class Link:
    """A sender's rate, Hz, and the greatest jitter of its way, s."""

    hz: float
    jitter_s: float


LINKS = (Link(10.0, 0.060), Link(30.0, 0.020), Link(50.0, 0.012))
# lag ms, rms error mrad, rms jerk rad/s³: what simulations of such goals reach at 30 Hz
BOUND = {"stamped, interpolating": (64.0, 1.1, 45.0), "stamped, extrapolating": (40.0, None, 60.0)}

Goals = np.ndarray
Target = tuple[float, float]


def run(context: Context) -> list[Comparison]:
    signal = motion(context.rng.uniform(0.0, 2.0 * np.pi, len(HZ)))
    ideal = figures(np.array([signal(t) for t in clock()]), signal)
    found: dict[tuple[str, str], tuple[float, ...]] = {("the motion itself", "-"): ideal}
    curves: dict[str, Goals] = {}
    chunk_curves: dict[str, Goals] = {}
    for link in LINKS:
        arrivals = single_targets(signal, link, context.rng)
        for name, goal in goals(context, signal, link, arrivals).items():
            found[name, f"{link.hz:g} Hz"] = figures(goal, signal)
            if link.hz == 30.0:
                curves[name] = goal
    for size in (16, 50):
        for name, goal in chunk_goals(context, signal, size).items():
            found[name, f"chunks of {size}"] = figures(goal, signal)
            if size == 16:
                chunk_curves[name] = goal
    write_table(context, found)
    draw(context, curves, chunk_curves, signal, found)
    return comparisons(found)


def comparisons(found: dict[tuple[str, str], tuple[float, ...]]) -> list[Comparison]:
    checks = []
    for name, (lag, rms, jerk) in BOUND.items():
        values = found[name, "30 Hz"]
        checks.append(at_most(f"lag at 30 Hz, {name}", lag, values[0], "ms"))
        if rms is not None:
            checks.append(at_most(f"rms error at 30 Hz, {name}", rms, values[1], "mrad"))
        checks.append(at_most(f"rms jerk at 30 Hz, {name}", jerk, values[3], "rad/s³"))
    lag = found["chunks of one policy", "chunks of 50"][0]
    checks.append(at_most("lag of 50-step chunks of one policy", 0.0, lag, "ms"))
    stamped = found["stamped, interpolating", "30 Hz"][4]
    for other in ("hold the newest", "linear"):
        name = f"peak force at a contact at 30 Hz, beside that of {other}"
        checks.append(at_most(name, found[other, "30 Hz"][4], stamped, "N"))
    for size in (16, 50):
        cut, faded = (
            found[f"chunks that disagree, {how}", f"chunks of {size}"][2]
            for how in ("cut over", "faded")
        )
        checks.append(at_most(f"peak acceleration, chunks of {size}", 0.1 * cut, faded, "rad/s²"))
    return checks


def clock() -> np.ndarray:
    return np.arange(round(LENGTH_S / T)) * T


def motion(phase: np.ndarray) -> Callable[[float], float]:
    """Peak speed 1 rad/s."""
    w = 2.0 * np.pi * HZ
    t = clock()
    fastest = np.abs((AMPLITUDE * w * np.cos(np.outer(t, w) + phase)).sum(axis=1)).max()
    return lambda at: float((AMPLITUDE / fastest * np.sin(w * at + phase)).sum())


def single_targets(
    signal: Callable[[float], float], link: Link, rng: np.random.Generator
) -> list[tuple[float, Target]]:
    """Arrival, and time and value of each target that comes; overtaken ones are dropped."""
    sent, newest_s = [], -1.0
    for stamp_s in np.arange(0.0, LENGTH_S, 1.0 / link.hz):
        arrival_s = stamp_s + TRANSPORT_S + link.jitter_s * rng.uniform()
        if rng.uniform() < LOSS or arrival_s < newest_s:
            continue
        newest_s = arrival_s
        sent.append((arrival_s, (float(stamp_s), signal(stamp_s))))
    return sent


def goals(
    context: Context,
    signal: Callable[[float], float],
    link: Link,
    arrivals: list[tuple[float, Target]],
) -> dict[str, Goals]:
    period_s = 1.0 / link.hz
    late_s = link.jitter_s + TRANSPORT_S
    return {
        "hold the newest": held(arrivals, signal(0.0)),
        "linear": linear(arrivals, signal(0.0), period_s),
        "EMA, 0.1 a cycle": averaged(held(arrivals, signal(0.0))),
        "track(), quintic to rest": quintics(arrivals, signal(0.0), max(0.1, 3.0 * period_s)),
        "stamped, extrapolating": stream(context, signal, arrivals, late_s),
        "stamped, interpolating": stream(context, signal, arrivals, late_s + period_s),
    }


def stream(
    context: Context,
    signal: Callable[[float], float],
    arrivals: list[tuple[float, Target]],
    delay_s: float,
) -> Goals:
    messages = [[at, [stamp + delay_s], [value]] for at, (stamp, value) in arrivals]
    return evaluated(context, signal(0.0), messages)


def evaluated(context: Context, x0: float, messages: list[list[object]]) -> Goals:
    arrivals, times, positions = (list(part) for part in zip(*messages, strict=True))
    sent = {"arrivals": arrivals, "times": times, "positions": positions}
    inputs = {"x0": x0, "n": len(clock()), "messages": sent, **BOUNDS}
    return np.asarray(context.eval([case("target_stream_seq", **inputs)])[0]["x"])


def chunk_goals(context: Context, signal: Callable[[float], float], size: int) -> dict[str, Goals]:
    """Chunks at 30 Hz, a new one after half of one, 0.1 s late; those that disagree do so by 20
    mrad, and a tenth of them are lost.
    """
    h, every = 1.0 / 30.0, size // 2
    chunks, off_chunks = [], []
    for first in range(0, round(LENGTH_S / h), every):
        times = h * (first + np.arange(size))
        values = np.array([signal(t) for t in times])
        off = context.rng.uniform(-0.02, 0.02)
        parts = [slice(k, k + 16) for k in range(0, size, 16)]
        at = h * first + 0.1
        chunks += [[at, times[p].tolist(), values[p].tolist()] for p in parts]
        if context.rng.uniform() >= LOSS:
            off_chunks.append((at, times, values + off))
    faded = [
        [at, times[p].tolist(), values[p].tolist()]
        for at, times, values in off_chunks
        for p in (slice(k, k + 16) for k in range(0, size, 16))
    ]
    return {
        "chunks of one policy": evaluated(context, signal(0.0), chunks),
        "chunks that disagree, faded": evaluated(context, signal(0.0), faded),
        "chunks that disagree, cut over": cut_over(off_chunks, signal(0.0)),
    }


def held(arrivals: list[tuple[float, Target]], start: float) -> Goals:
    times = np.array([at for at, _ in arrivals])
    values = np.array([start, *(value for _, (_, value) in arrivals)])
    return np.asarray(values[np.searchsorted(times, clock(), side="right")])


def linear(arrivals: list[tuple[float, Target]], start: float, period_s: float) -> Goals:
    """From where the goal is to the newest target in one period after it came."""
    goal, x, k = np.empty(len(clock())), start, 0
    rate, end_s = 0.0, 0.0
    for i, t in enumerate(clock()):
        while k < len(arrivals) and arrivals[k][0] <= t:
            rate, end_s = (arrivals[k][1][1] - x) / period_s, t + period_s
            k += 1
        x += rate * T if t < end_s else 0.0
        goal[i] = x
    return goal


def averaged(goal: Goals) -> Goals:
    out, x = np.empty_like(goal), goal[0]
    for i, value in enumerate(goal):
        x += 0.1 * (value - x)
        out[i] = x
    return out


def quintics(arrivals: list[tuple[float, Target]], start: float, horizon_s: float) -> Goals:
    """To rest at the newest target, on from the motion under way."""
    goal, state, k = np.empty(len(clock())), np.array([start, 0.0, 0.0]), 0
    c, begun_s = np.array([start, 0.0, 0.0, 0.0, 0.0, 0.0]), 0.0
    for i, t in enumerate(clock()):
        while k < len(arrivals) and arrivals[k][0] <= t:
            x, v, a = state
            d, V, A = arrivals[k][1][1] - x, v * horizon_s, a * horizon_s**2
            c = np.array(
                [
                    x,
                    V,
                    A / 2,
                    10 * d - 6 * V - 1.5 * A,
                    -15 * d + 8 * V + 1.5 * A,
                    6 * d - 3 * V - A / 2,
                ]
            )
            begun_s, k = t - T, k + 1  # where the state is of
        s = min((t - begun_s) / horizon_s, 1.0)
        powers = s ** np.arange(6)
        n = np.arange(6)
        state = np.array(
            [
                c @ powers,
                (n[1:] * c[1:]) @ powers[:-1] / horizon_s,
                (n[2:] * n[1:-1] * c[2:]) @ powers[:-2] / horizon_s**2,
            ]
        )
        goal[i] = state[0]
    return goal


def cut_over(chunks: list[tuple[float, np.ndarray, np.ndarray]], start: float) -> Goals:
    goal = np.full(len(clock()), start)
    for at, times, values in chunks:
        rows = clock() >= at
        goal[rows] = np.interp(clock()[rows], times, values)
    return goal


def figures(goal: Goals, signal: Callable[[float], float]) -> tuple[float, ...]:
    """Lag, ms; rms error after it, mrad; peak acceleration; rms jerk; peak contact force, N."""
    truth = np.array([signal(t) for t in clock()])
    errors = [
        np.sqrt(np.mean((goal[SETTLED] - truth[SETTLED.start - lag : SETTLED.stop - lag]) ** 2))
        for lag in range(300)
    ]
    lag = int(np.argmin(errors))
    a = np.diff(goal, 2)[SETTLED] / T**2
    jerk = np.diff(a) / T
    return (
        float(lag),
        1e3 * float(errors[lag]),
        float(np.abs(a).max()),
        float(np.sqrt(np.mean(jerk**2))),
        contact_force(goal),
    )


def contact_force(goal: Goals) -> float:
    """Greatest force on a wall halfway of the goal's way, by a mass on the spring of its goal."""
    x_d = REACH * goal
    wall = float(np.quantile(x_d[SETTLED], 0.5))
    damping = 2.0 * RATIO * np.sqrt(MASS * STIFFNESS)
    v_d = np.diff(x_d, prepend=x_d[0]) / T
    x, v, most = float(x_d[0]), 0.0, 0.0
    for i in range(SETTLED.stop):
        force = WALL * max(x - wall, 0.0)
        v += T * (STIFFNESS * (x_d[i] - x) + damping * (v_d[i] - v) - force) / MASS
        x += T * v
        most = max(most, force if i >= SETTLED.start else 0.0)
    return most


def write_table(context: Context, found: dict[tuple[str, str], tuple[float, ...]]) -> None:
    head = (
        "| goal | targets | lag ms | rms error mrad | peak rad/s² | rms jerk rad/s³ | contact N |"
    )
    rows = [head, "|---|---|---|---|---|---|---|"]
    for (name, targets), values in found.items():
        numbers = " | ".join(f"{value:.3g}" for value in values)
        rows.append(f"| {name} | {targets} | {numbers} |")
    (context.out / "table.md").write_text("\n".join(rows) + "\n", encoding="utf-8")


def draw(
    context: Context,
    curves: dict[str, Goals],
    chunk_curves: dict[str, Goals],
    signal: Callable[[float], float],
    found: dict[tuple[str, str], tuple[float, ...]],
) -> None:
    with context.picture(TITLE, rows=2, columns=2, size=(14.0, 11.0)) as axes:
        draw_goals(axes[0, 0], curves, signal, slice(6000, 7600), "goal at 30 Hz (rad)")
        draw_goals(axes[1, 0], chunk_curves, signal, slice(6000, 9000), "chunks of 16 (rad)")
        rates = [f"{link.hz:g} Hz" for link in LINKS]
        for name in curves:
            lag, _, _, jerk, force = zip(*(found[name, rate] for rate in rates), strict=True)
            axes[0, 1].plot(lag, jerk, "o-", lw=1.0, label=name)
            axes[1, 1].plot(rates, force, "o-", lw=1.0, label=name)
        _, _, _, jerk, force = found["the motion itself", "-"]
        axes[0, 1].axhline(jerk, color=BLACK, ls="--", lw=1.2)
        axes[0, 1].set_yscale("log")
        name_axes(axes[0, 1], "lag (ms) at 50, 30, 10 Hz", "rms jerk (rad/s³); dashed: the motion")
        axes[1, 1].axhline(force, color=BLACK, ls="--", lw=1.2)
        name_axes(axes[1, 1], "targets", "greatest contact force (N); dashed: the motion")
        for ax in axes.flat:
            ax.legend(loc="best", fontsize=8)


def draw_goals(
    ax: Axes,
    curves: dict[str, Goals],
    signal: Callable[[float], float],
    rows: slice,
    what: str,
) -> None:
    t = clock()[rows] - clock()[rows.start]
    ax.plot(t, [signal(at) for at in clock()[rows]], color=BLACK, lw=2.5, label="motion")
    for name, goal in curves.items():
        ax.plot(t, goal[rows], lw=1.1, label=name)
    name_axes(ax, "time (s)", what)
