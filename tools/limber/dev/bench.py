"""`limber bench`: builds the release preset, runs its benchmarks, each figure beside its peer.

Only ratios travel between machines. Competitors are interleaved in one run (repetitions in random
order), and the median of the processor's time counts.
"""

import json
import subprocess
import sys
from dataclasses import dataclass

from rich.console import Console
from rich.table import Table

from limber.dev import bench_round_trips
from limber.errors import OK, RunError
from limber.live import network
from limber.paths import RELEASE, ROOT

MODULES = ("limber.dev.bench_receiver", "limber.dev.bench_page", "limber.dev.bench_viewer")
OPTIONS = [
    "--benchmark_format=json",
    "--benchmark_repetitions=9",
    "--benchmark_min_time=0.02",
    "--benchmark_enable_random_interleaving=true",
    "--benchmark_report_aggregates_only=true",
]
PEER = "impedance/pinocchio/7"
JOINTS = range(1, 17)
Medians = dict[str, float]  # ns, by the benchmark's name


@dataclass(frozen=True)
class Figure:
    """What was measured and its peer, ns; the ratio must not exceed the goal, if there is one."""

    name: str
    own_ns: float
    peer: str
    peer_ns: float | None
    goal: float | None = None

    @property
    def ratio(self) -> float | None:
        return None if self.peer_ns is None else self.own_ns / self.peer_ns

    @property
    def verdict(self) -> str:
        if self.ratio is None:
            return "peer not installed"
        if self.goal is None:
            return ""
        return "met" if self.ratio <= self.goal else "missed"

    def as_json(self) -> dict[str, object]:
        return {
            "name": self.name,
            "own_ns": self.own_ns,
            "peer": self.peer,
            "peer_ns": self.peer_ns,
            "ratio": self.ratio,
            "goal": self.goal,
            "verdict": self.verdict,
        }


def figures(medians: Medians) -> list[Figure]:
    """All figures with a peer, from the medians of one run of limber-bench."""

    def beside(name: str, own: str, peer: str, goal: float | None = None) -> Figure:
        return Figure(name, medians[own], peer, medians.get(peer), goal)

    found = [
        beside("terms and Cartesian impedance, 7 joints", "impedance/limber/7", PEER, 0.25),
        beside("the same", "impedance/limber/7", "impedance/kdl/7"),
    ]
    for n in JOINTS:
        found.append(beside(f"terms, {n} joints", f"terms/limber/{n}", f"terms/pinocchio/{n}"))
    found.append(beside("terms, 7 joints", "terms/limber/7", "terms/kdl/7"))
    for name in medians:
        if name.startswith("BM_ControllerCycle/"):
            _, kind, law = name.split("/")
            goal = 0.6 if law == "cartesian_impedance" else 1.0
            found.append(beside(f"whole controller cycle, {law} ({kind})", name, PEER, goal))
    step = "simulated step of 1 ms, rigid arm, Runge-Kutta"
    found.append(beside(step, "plant_step/reference", "plant_step/bare_ode", 0.2))
    found.append(beside("the same by ODE", "plant_step/ode", "plant_step/bare_ode", 1.1))
    return found


def medians_of(report: dict) -> Medians:
    """From the JSON of limber-bench. A benchmark that could not run is an error."""
    for row in report["benchmarks"]:
        if row.get("error_occurred"):
            raise RunError(f"limber-bench: {row['name']}: {row.get('error_message', 'failed')}")
    return {
        row["run_name"]: row["cpu_time"]
        for row in report["benchmarks"]
        if row.get("aggregate_name") == "median"
    }


def bench(console: Console, as_json: bool = False) -> int:
    """Runs in a private network where that is permitted, away from other messages."""
    quiet = Console(stderr=True) if as_json else console
    for command in (["cmake", "--preset", "release"], ["cmake", "--build", "--preset", "release"]):
        _run(command, quiet, " ".join(command))
    prefix = network.private_command() or []
    quiet.rule("limber-bench: some minutes")
    medians = medians_of(json.loads(_run([str(RELEASE / "limber-bench"), *OPTIONS], None)))
    found = figures(medians)
    found += [Figure(*row) for row in bench_round_trips.rows(prefix)]
    if as_json:
        print(json.dumps([figure.as_json() for figure in found], indent=1))
        return OK
    console.print(_table(found))
    for name, ns in medians.items():
        if name.startswith(("BM_LabCycle", "term_")):
            console.print(f"{name:60} {ns / 1000:9.2f} µs")
    for module in MODULES:
        _run([*prefix, sys.executable, "-m", module], console, module)
    return OK


def _table(found: list[Figure]) -> Table:
    table = Table("figure", "µs", "peer", "its µs", "ratio", "goal", "verdict")
    for figure in found:
        table.add_row(
            figure.name,
            f"{figure.own_ns / 1000:.2f}",
            figure.peer,
            "" if figure.peer_ns is None else f"{figure.peer_ns / 1000:.2f}",
            "" if figure.ratio is None else f"{figure.ratio:.2f}",
            "" if figure.goal is None else f"{figure.goal:.2f}",
            figure.verdict,
        )
    return table


def _run(command: list[str], console: Console | None, title: str | None = None) -> str:
    """What the program prints; without a console it is only returned."""
    title = title or command[0]
    if console is not None:
        console.rule(title)
    to = subprocess.PIPE if console is None else (sys.stderr if console.stderr else None)
    try:
        done = subprocess.run(command, cwd=ROOT, check=False, stdout=to, text=True)
    except FileNotFoundError as error:
        raise RunError(f"{command[0]} is missing") from error
    if done.returncode != 0:
        raise RunError(f"{title} failed (exit code {done.returncode}): see above")
    return done.stdout or ""
