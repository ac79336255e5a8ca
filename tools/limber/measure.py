"""The numbers of a run, from its log alone: nothing is asked of the code that produced it."""

import platform
from importlib import metadata

from limber import __version__
from limber.contact import contact_results
from limber.health import health_results
from limber.logs import Log
from limber.pushes import Measured, matrix_results, measure_pushes, push_results
from limber.results import Summary
from limber.scenario import Scenario


def measure(
    log: Log, scenario: Scenario, mode: str, recorder_lost: dict[str, int] | None = None
) -> tuple[Summary, list[Measured]]:
    truth = log.read("SIM_TRUTH")
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
