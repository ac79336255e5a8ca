"""The numbers of a run, computed from its log alone, without the code that produced it."""

import platform
from importlib import metadata

from limber import __version__
from limber.log.reader import Log
from limber.measure.contact import contact_results
from limber.measure.health import health_results
from limber.measure.pushes import MeasuredPush, matrix_results, measure_pushes, push_results
from limber.measure.results import Summary
from limber.measure.sound import sound
from limber.model.scenario import Scenario


def measure(
    log: Log, scenario: Scenario, mode: str, recorder_lost: dict[str, int] | None = None
) -> tuple[Summary, list[MeasuredPush]]:
    truth = sound(log.read("SIM_TRUTH"))
    pushes = measure_pushes(log, scenario)
    tolerances = scenario.tolerances
    results = health_results(log, scenario, recorder_lost or {})
    results += push_results(pushes, tolerances.stiffness)
    results += matrix_results(pushes, tolerances.stiffness, scenario.friction)
    results += contact_results(truth, scenario, tolerances.contact_force)
    return Summary(_header(log, scenario, mode), results), pushes


def _header(log: Log, scenario: Scenario, mode: str) -> dict:
    header = {
        "scenario": scenario.name,
        "robot": scenario.robot.name,
        "mode": mode,
        "seed": scenario.seed,
        "friction": scenario.friction,
        "versions": {
            "limber": __version__,
            "lcm": metadata.version("lcm"),
            "python": platform.python_version(),
            "machine": platform.machine(),
        },
    }
    if log.damage():
        header["damage"] = log.damage()
    return header
