"""One run of a sweep, on a worker: the lab in a folder of its own, and one row of numbers."""

import signal
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from distributed import get_worker

from limber.errors import WRONG_INPUT, InputError, RunError
from limber.log.reader import Log
from limber.measure.health import LOST_REPLIES
from limber.measure.summarize import measure
from limber.measure.transients import transient
from limber.model.scenario import Scenario, load_scenario
from limber.paths import captured, program
from limber.sweep.definition import Files, versions, write_files

HOLDS, BEYOND, FAULT, REFUSED = OUTCOMES = ("holds", "out of tolerance", "fault", "refused")
CRASHES = (signal.SIGSEGV, signal.SIGABRT, signal.SIGFPE)  # again and again; no kill from outside


def one_run(
    run: int, values: dict[str, Any], files: Files, overshoot: float, sweep_versions: dict[str, str]
) -> dict[str, Any]:
    """The row. Raises RunError for what the machine is to blame for; all else is in the row."""
    if versions() != sweep_versions:
        raise RunError(f"this worker has {versions()}; the sweep {sweep_versions}")
    with TemporaryDirectory(dir=get_worker().local_directory) as folder:  # emptied after a kill
        try:
            scenario = load_scenario(write_files(files, Path(folder)))
            row = judge(_lab(scenario), scenario, overshoot)
        except (InputError, ArithmeticError, ValueError) as error:
            row = {"outcome": REFUSED, "reason": str(error).replace(f"{folder}/", "")}
    return {"run": run, **values, **row}


def _lab(scenario: Scenario) -> Path:
    """Returns its log."""
    log = scenario.path.with_name("run.lcmlog")
    done = captured([str(program("limber-lab")), str(scenario.path), "--log", str(log)])
    if done.returncode == 0:
        return log
    last = (done.stderr.strip().splitlines() or ["no output"])[-1].removeprefix("limber-lab: ")
    if done.returncode == WRONG_INPUT or -done.returncode in CRASHES:
        raise InputError(last)
    raise RunError(f"limber-lab ended with exit code {done.returncode}: {last}")


def judge(log_file: Path, scenario: Scenario, overshoot: float) -> dict[str, Any]:
    """All of a row but number and values. What `limber lab` judges is judged as it does; replies
    that the wire loses are no failure by themselves.
    """
    log = Log(log_file)
    summary, pushes = measure(log, scenario, "lab")
    failed = [r for r in summary.results if r.passed is False and r.name != LOST_REPLIES]
    refused = [result.note for result in failed if result.name == "requests refused"]
    whole = [push for push in pushes if not summary.disturbed(push.span)]
    found = [way for push in whole if (way := transient(log.read("SIM_TRUTH"), push)) is not None]
    most, settling_s = map(max, zip(*found, strict=True)) if found else (None, None)
    beyond = ["overshoot"] * (most is not None and most > overshoot)
    if refused:
        outcome, reason = REFUSED, refused[0]
    elif summary.faults and not scenario.faults:
        outcome, reason = FAULT, summary.faults[0].title
    elif failed or beyond:
        outcome, reason = BEYOND, ", ".join([*(result.name for result in failed), *beyond])
    else:
        outcome, reason = HOLDS, ""
    errors = [
        abs(float(result.value) / float(result.expected) - 1.0)
        for result in summary.results
        if result.unit in ("N/m", "N m/rad") and result.expected and result.passed is not None
    ]
    limits = np.array([joint.torque for joint in scenario.robot.joints])
    torque = np.abs(log.read("JOINT_STATE")["tau_applied"][:, : len(limits)])
    return {
        "outcome": outcome,
        "fault": summary.faults[0].problem.code if summary.faults else "",
        "reason": reason,
        "overshoot": most,
        "stiffness_error": max(errors, default=None),
        "settling_s": settling_s,
        "peak_torque_of_limit": float((torque / limits).max(initial=0.0)),
    }
