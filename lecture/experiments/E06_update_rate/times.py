"""What the terms cost that a slower evaluation would save: times of this machine, by limber-bench.

The one thing here that depends on the machine. So only ratios are judged, and those only where the
benchmarks have been built (`limber dev bench` does).
"""

import json
import os
import subprocess

from limber.errors import RunError
from limber.paths import RELEASE
from limber_lecture.context import Comparison, Context, at_most
from limber_lecture.pictures import BLUE, ORANGE, Axes

PROGRAM = "limber-bench"
TERMS = {
    "term_jacobian": "J",
    "term_inertia": "M",
    "term_inverse_dynamics": "inverse\ndynamics",
    "term_stiffness": "all of\nEq. 4",
}
CYCLE = "BM_ControllerCycle/rigid/computed_torque"
TIMEOUT_S = 60.0


def measure(context: Context) -> dict[str, float]:
    """Median of the processor's time in µs, by the benchmark's name; empty if not built."""
    path = RELEASE / PROGRAM
    if not os.access(path, os.X_OK):
        context.progress(f"{PROGRAM} is not built: no times of single terms")
        return {}
    chosen = "|".join(f"{name}$" for name in (*TERMS, CYCLE))
    options = ["--benchmark_format=json", "--benchmark_min_time=0.05", "--benchmark_repetitions=7"]
    command = [str(path), f"--benchmark_filter={chosen}", *options]
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=TIMEOUT_S, check=True
        )
        rows = json.loads(done.stdout)["benchmarks"]
    except (subprocess.SubprocessError, ValueError, KeyError) as error:
        raise RunError(f"{PROGRAM}: {error}") from error
    found = {
        row["run_name"]: row["cpu_time"] * 1e-3
        for row in rows
        if row.get("aggregate_name") == "median"
    }
    if missing := {*TERMS, CYCLE} - found.keys():
        raise RunError(f"{PROGRAM} says nothing of {', '.join(sorted(missing))}")
    return found


def checks(found: dict[str, float]) -> list[Comparison]:
    """Nothing that is done in a cycle can take longer than the cycle."""
    if not found:
        return []
    whole = found[CYCLE]
    return [
        at_most(
            f"time of {' '.join(word.split())} over a whole cycle of computed_torque",
            1.0,
            found[name] / whole,
        )
        for name, word in TERMS.items()
        if name != "term_stiffness"
    ]


def draw(found: dict[str, float], ax: Axes) -> None:
    names = [*TERMS, CYCLE]
    labels = [*TERMS.values(), "whole cycle\n(computed torque)"]
    colors = [*[BLUE] * len(TERMS), ORANGE]
    bars = ax.bar(labels, [found[name] for name in names], color=colors, alpha=0.6)
    ax.bar_label(bars, fmt="%.1f")
    ax.set_title("Time of each on this machine, seven joints")
    ax.set_ylabel("time (µs); a cycle at 1 kHz has 1000")
