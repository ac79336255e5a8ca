"""Runs the lock-step faults of a row and judges each phase: the driver's reaction, and the trace.

The driver tells what it did in JOINT_STATE; the trace checker tells what was on the bus.
"""

import json
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from limber.errors import RunError
from limber.messages import constants
from limber.paths import captured, program
from limber_qa.check_trace.arm import Arm, read_arm
from limber_qa.check_trace.candump import read_trace
from limber_qa.check_trace.judge import judge
from limber_qa.check_trace.stops import Expectation
from limber_qa.faults.matrix import LockStepRun, Row

PHASES = 20
STATES = {"FALLBACK": "HOLD", "DAMP": "DAMP", "FAULT": "FAULT"}  # the driver's words


@dataclass(frozen=True)
class RunResult:
    """`cycles`: the latest reaction; `stop_ms`: the latest first safe frame, by the trace.

    `problems`: what was not as expected, "phase 3: ..." each.
    """

    run: LockStepRun
    phases: int
    cycles: int
    stop_ms: float | None
    moved_on_rad: float
    moved_rad: float
    speed_rad_per_s: float
    problems: list[str]

    @property
    def passed(self) -> bool:
        return not self.problems


def fault_names() -> dict[str, list[str]]:
    """Every fault of limber-faults and the families that have it."""
    listed = json.loads(_limber_faults("--list"))["faults"]
    return {fault["name"]: fault["families"] for fault in listed}


def run_row(row: Row, phases: int = PHASES) -> Iterator[RunResult]:
    for run in row.lock_step:
        yield run_fault(run, phases)


def run_fault(run: LockStepRun, phases: int = PHASES) -> RunResult:
    with tempfile.TemporaryDirectory() as folder:
        traces = [] if run.unjudged else ["--traces", folder]
        text = _limber_faults(run.fault, "--phases", str(phases), "--family", run.family, *traces)
        cell = json.loads(text)["faults"][0]["families"].get(run.family)
        if cell is None:
            raise RunError(f"{run.family} drives do not have the fault '{run.fault}'")
        arm = read_arm(cell["robot"])
        problems: list[str] = []
        stops: list[float] = []
        for phase, reaction in enumerate(cell["each"]):
            found = list(_wrong(run, reaction))
            if traces:
                trace = Path(folder) / f"{run.family}-{phase}.log"
                stops += _judge(run, reaction, trace, arm, found)
            problems += [f"phase {phase}: {text}" for text in found]
    return RunResult(
        run,
        phases,
        cell["cycles"][1],
        max(stops, default=None),
        cell["moved_on_rad"],
        cell["moved_rad"],
        cell["speed_rad_per_s"],
        problems,
    )


def _wrong(run: LockStepRun, reaction: dict[str, Any]) -> Iterator[str]:
    """What the driver said, against what is expected."""
    state = constants("joint_state_t", "DRIVE_")[reaction["state"]]
    cause = constants("joint_state_t", "FAULT_")[reaction["cause"]]
    cycles = reaction["cycles"]
    if run.reaction == "stopped" and cycles < 0:
        yield "the drives never left ON"
    elif run.reaction == "stopped" and state != "HOLD":
        yield f"{state} after {cycles} cycles, expected FALLBACK"
    if run.reaction in STATES:
        if not 1 <= cycles <= run.cycles:
            late = f"after {cycles} cycles" if cycles > 0 else "never"
            yield f"the drives left ON {late}, expected within {run.cycles}"
        elif state != STATES[run.reaction]:
            yield f"{state.replace('HOLD', 'FALLBACK')}, expected {run.reaction}"
        elif run.cause and cause != run.cause:
            yield f"cause {cause}, expected {run.cause}"
        elif run.joint and reaction["joint"] != run.joint - 1:
            yield f"names joint {reaction['joint'] + 1}, expected {run.joint}"
    if run.reaction in ("bridged", "refused") and cycles >= 0:
        yield f"{state.replace('HOLD', 'FALLBACK')} ({cause}) after {cycles} cycles, expected none"
    if run.reaction == "refused" and reaction["refused"] == 0:
        yield "no command was refused"
    verdict = constants("driver_status_t", "VERDICT_")[reaction["verdict"]]
    if run.verdict and verdict != run.verdict:
        yield f"most commands were refused by {verdict}, expected {run.verdict}"
    for key, when in (("moved_rad", ""), ("moved_on_rad", " while the drives were ON")):
        most = getattr(run, key)
        if most and not reaction[key] <= most:
            yield f"a joint moved {reaction[key]:.2f} rad{when}, expected {most} at most"
    if reaction["returned"]:
        yield "the drives were ON again although nobody acknowledged"


def _judge(
    run: LockStepRun, reaction: dict[str, Any], trace: Path, arm: Arm, found: list[str]
) -> list[float]:
    """Adds the trace checker's complaints; the time to the first safe frame, if there is one."""
    leaves_on = run.reaction in STATES
    expected = Expectation(
        fault_ns=reaction["fault_ns"] if leaves_on else None,
        stop_ns=run.cycles * arm.period_ns if leaves_on else None,
        latched=leaves_on,
    )
    verdict = judge(read_trace(trace), arm, expected)
    found += [
        f"trace: {breach.joint}: {breach.rule} {breach.number:.4g} {breach.unit} "
        f"(limit {breach.limit:.4g}): {breach.text}"
        for breach in verdict.breaches[:3]
    ]
    return [] if verdict.stop_ms is None else [verdict.stop_ms]


def _limber_faults(*words: str) -> str:
    command = [str(program("limber-faults")), *words]
    done = captured(command)
    if done.returncode != 0:
        raise RunError(f"limber-faults ended with {done.returncode}: {done.stderr.strip()}")
    return done.stdout
