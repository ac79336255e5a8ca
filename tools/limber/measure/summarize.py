"""The numbers of a run, computed from its log alone, without the code that produced it."""

import os
import platform
from hashlib import sha256
from pathlib import Path

from limber import __version__
from limber.log.reader import Log
from limber.measure.contact import contact_results
from limber.measure.faults import find_faults
from limber.measure.grasp import grasp_results
from limber.measure.health import health_results, stopped_s
from limber.measure.pushes import MeasuredPush, matrix_results, measure_pushes, push_results
from limber.measure.results import Result, Summary
from limber.measure.sound import sound
from limber.model.scenario import Scenario


def measure(
    log: Log,
    scenario: Scenario,
    mode: str,
    recorder_lost: dict[str, int] | None = None,
    stopped: bool = False,
    recorder_dropped: int = 0,
) -> tuple[Summary, list[MeasuredPush]]:
    """`stopped`: by the user, before the scenario was over; what follows is not judged."""
    end_s = stopped_s(log) if stopped else scenario.duration_s
    faults = find_faults(log, scenario.robot, end_s)
    truth = sound(log.read("SIM_TRUTH"))
    pushes = measure_pushes(log, scenario)
    tolerances = scenario.tolerances
    results = [Result("stopped", f"by you after {end_s:.1f} s")] if stopped else []
    results += health_results(log, scenario, recorder_lost or {}, recorder_dropped, faults)
    results += push_results(pushes, tolerances.stiffness)
    results += matrix_results(pushes, tolerances.stiffness, scenario.friction)
    results += contact_results(truth, scenario, tolerances.contact_force)
    results += grasp_results(log, scenario)
    summary = Summary(_header(log, scenario, mode), results, faults)
    summary.leave_out_disturbed()
    return summary, pushes


def _header(log: Log, scenario: Scenario, mode: str) -> dict:
    header = {
        "scenario": scenario.name,
        "robot": scenario.robot.name,
        "mode": mode,
        "seed": scenario.seed,
        "friction": scenario.friction,
        "versions": {
            "limber": __version__,
            "python": platform.python_version(),
            "machine": platform.machine(),
        },
    }
    files = [*scenario.law_files, *filter(None, os.environ.get("LIMBER_LAWS", "").split(":"))]
    if files:
        header["law_files_sha256"] = {file: _sha256(Path(file)) for file in files}
    if log.damage():
        header["damage"] = log.damage()
    return header


def _sha256(file: Path) -> str | None:
    return sha256(file.read_bytes()).hexdigest() if file.is_file() else None
