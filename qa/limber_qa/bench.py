"""`limber dev bench`: builds the release preset, runs its benchmarks, each figure beside its peer.

Only ratios travel between machines. Competitors are interleaved in one run (repetitions in random
order), and the median of the processor's time counts.
"""

import json
import os
import re
import sys
import tempfile
from pathlib import Path
from typing import Any

from rich.console import Console

from limber.errors import OK, RunError
from limber.live import network
from limber.paths import ROOT
from limber_qa import bench_loop_parts, bench_round_trips
from limber_qa.bench_command import released, run
from limber_qa.bench_figure import Figure, table

MODULES = ("limber_qa.bench_page", "limber_qa.bench_viewer", "limber_qa.bench_gym")
READ_SCENARIO = Path("scenarios") / "quick.yaml"
CYCLES = 1_000_000  # watched for calls
LOADED_s = 10.0  # of the recorder
LONG_CYCLES, LONG_LOADED_s = 10_000_000, 60.0
OPTIONS = [
    "--benchmark_format=json",
    "--benchmark_repetitions=9",
    "--benchmark_min_time=0.02",
    "--benchmark_enable_random_interleaving=true",
    "--benchmark_report_aggregates_only=true",
]
PEER = "impedance/pinocchio/7"
# What is measured again for each level of the kernel that the processor has (LIMBER_PROCESSOR).
OF_LEVELS = (
    "terms/(limber|pinocchio)/|impedance/(limber|pinocchio)/7$|plant_step/(reference|mujoco|bare)"
    "|BM_ControllerCycle/"
)
JOINTS = range(1, 17)
# Ratios that are asked for: benchmark and peer, with AVX-512, with AVX2. The first that fits holds.
GOALS = (
    (r"impedance/limber/7 impedance/pinocchio/7", 0.20, 0.30),
    (r"terms/limber/[1-6] terms/pinocchio/", 0.40, 0.50),
    (r"BM_ControllerCycle/rigid/cartesian_impedance ", 0.70, 0.90),
    (r"BM_ControllerCycle/rigid/gravity_compensation ", 0.50, 0.60),
    (r"BM_ControllerCycle/rigid/", 1.20, 1.50),
    (r"BM_ControllerCycle/", 1.60, 2.00),
    (r"plant_step/reference plant_step/mujoco", 0.70, 1.00),
    (r"plant_step/reference plant_step/bare_ode", 0.20, 0.35),
)
Medians = dict[str, float]  # ns, by the benchmark's name


def goal(level: str, own: str, peer: str) -> float | None:
    """Of the kernel at that level; of the plain one nothing is asked."""
    for pattern, avx512, avx2 in GOALS:
        if re.match(pattern, f"{own} {peer}"):
            return {"avx512": avx512, "avx2": avx2}.get(level)
    return None


def level_figures(level: str, medians: Medians) -> list[Figure]:
    """What depends on the kernel's level, each with a peer of the same run."""
    pairs = [("impedance/limber/7", PEER)]
    pairs += [(f"terms/limber/{n}", f"terms/pinocchio/{n}") for n in JOINTS]
    pairs += [(name, PEER) for name in medians if name.startswith("BM_ControllerCycle/")]
    pairs += [("plant_step/reference", f"plant_step/{name}") for name in ("mujoco", "bare_ode")]
    return [
        Figure(f"{own}, {level}", medians[own], peer, medians.get(peer), goal(level, own, peer))
        for own, peer in pairs
    ]


def figures(medians: Medians) -> list[Figure]:
    """The others that have a peer."""
    rows: list[tuple[str, str, float | None]] = [
        ("impedance/limber/7", "impedance/kdl/7", None),
        ("terms/limber/7", "terms/kdl/7", None),
        ("plant_step/ode", "plant_step/bare_ode", 1.1),
    ]
    found = [Figure(own, medians[own], peer, medians[peer], most) for own, peer, most in rows]
    kernels = medians["plant_step/reference"] + medians["impedance/limber/7"]
    lab = medians["lab_cycle/held"]
    return [*found, Figure("lab cycle without a log", lab, "its step and impedance", kernels, 1.5)]


def medians_of(found: dict) -> Medians:
    """From the JSON of limber-bench. A benchmark that could not run is an error."""
    for row in found["benchmarks"]:
        if row.get("error_occurred"):
            raise RunError(f"limber-bench: {row['name']}: {row.get('error_message', 'failed')}")
    return {
        row["run_name"]: row["cpu_time"]
        for row in found["benchmarks"]
        if row.get("aggregate_name") == "median"
    }


def bench(console: Console, as_json: bool = False, long: bool = False) -> int:
    """Runs in a private network where that is permitted, away from other messages."""
    quiet = Console(stderr=True) if as_json else console
    for command in (["cmake", "--preset", "release"], ["cmake", "--build", "--preset", "release"]):
        run(command, quiet, " ".join(command))
    prefix = network.private_command() or []
    quiet.rule("limber-bench and its peers: some minutes")
    report = _kernels()
    medians = medians_of(report)
    fastest, *others = report["context"]["levels"].split()
    found = level_figures(fastest, medians) + figures(medians)
    for level in others:
        run_again = _kernels(f"--benchmark_filter={OF_LEVELS}", LIMBER_PROCESSOR=level)
        found += level_figures(level, medians_of(run_again))
    quiet.print(f"{_processor()}; the kernel's levels: {', '.join([fastest, *others])}")
    found += bench_round_trips.figures(prefix)
    found.append(bench_loop_parts.exchange(prefix))
    found += bench_loop_parts.lateness()
    found += bench_loop_parts.calls(LONG_CYCLES if long else CYCLES)
    found += _of_module(
        prefix, "limber_qa.bench_recorder", str(LONG_LOADED_s if long else LOADED_s)
    )
    found += _reading()
    found += _of_module(prefix, "limber_qa.bench_waiting")
    if as_json:
        print(json.dumps([figure.as_json() for figure in found], indent=1))
        return OK
    console.print(table(found))
    for name, ns in medians.items():
        if name.startswith(("BM_LabCycle", "term_")):
            console.print(f"{name:60} {ns / 1000:9.2f} µs")
    for module in MODULES:
        run([*prefix, sys.executable, "-m", module], console, module)
    return OK


def _processor() -> str:
    """Its name, and which wide registers it has."""
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    known = dict(line.replace("\t", "").split(":", 1) for line in lines if ":" in line)
    flags = known.get("flags", known.get("Features", "")).split()
    sets = [
        flag for flag in ("asimd", "sve", "sse2", "avx", "avx2", "fma", "avx512f") if flag in flags
    ]
    return f"{known.get('model name', 'processor without a name').strip()} ({', '.join(sets)})"


def _kernels(*options: str, **environment: str) -> dict:
    """What limber-bench reports. MuJoCo, if it is there, reads the arm from a file."""
    with tempfile.TemporaryDirectory() as folder:
        arm = Path(folder) / "openarm.xml"
        export = [sys.executable, "-m", "limber", "export", "mjcf", "openarm", "--out", str(arm)]
        run(export, None, "limber export mjcf")
        env = {**os.environ, "LIMBER_BENCH_MJCF": str(arm), **environment}
        command = [released("limber-bench"), *OPTIONS, *options]
        found: dict[str, Any] = json.loads(run(command, None, env=env))
    return found


def _reading() -> list[Figure]:
    with tempfile.TemporaryDirectory() as folder:
        log = str(Path(folder) / "run.lcmlog")
        run([released("limber-lab"), str(ROOT / READ_SCENARIO), "--log", log], None)
        return _of_module([], "limber_qa.bench_receiver", log)


def _of_module(prefix: list[str], module: str, *options: str) -> list[Figure]:
    rows = json.loads(run([*prefix, sys.executable, "-m", module, *options], None, module))
    return [Figure(**row) for row in rows]
