"""The long commands: run, lab, measure. Check first, then run, then measure, then say it."""

import re
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from limber import network, runner
from limber.check import check_scenario
from limber.errors import OK, OUT_OF_TOLERANCE, InputError
from limber.logs import Log
from limber.measure import measure
from limber.paths import existing_file, output_folder
from limber.results import Summary, load_header
from limber.runner import RunOptions, RunResult
from limber.scenario import Scenario, load_scenario


@dataclass(frozen=True)
class RunRequest:
    """What `limber run` was asked for. `lockstep` None: as the scenario says."""

    scenario: Path
    out: Path | None
    lockstep: bool | None = None
    buses: tuple[str, ...] = ()
    with_simulator: bool = True
    private: bool = False


def next_folder(name: str) -> Path:
    """out/NAME-<n> with the lowest n that is free."""
    taken = [re.fullmatch(rf"{re.escape(name)}-(\d+)", path.name) for path in Path("out").glob("*")]
    number = 1 + max((int(match[1]) for match in taken if match), default=0)
    return Path("out") / f"{name}-{number}"


def load_checked(path: Path) -> Scenario:
    """The scenario, after the program that all others share has found nothing wrong with it."""
    existing_file(path, "scenario file (.yaml)")
    check_scenario(path)
    return load_scenario(path)


def run(request: RunRequest, console: Console) -> int:
    scenario = load_checked(request.scenario)
    runner.check_buses(scenario, request.buses)
    if request.buses and not request.with_simulator:
        console.print("[yellow]no simulator: whatever is on the bus will move[/]")
    network.ensure_multicast(request.private)
    folder = output_folder(request.out or next_folder(scenario.name))
    lockstep = scenario.lockstep if request.lockstep is None else request.lockstep
    options = RunOptions(lockstep, request.buses, request.with_simulator)
    result = runner.run(scenario, folder, options, console)
    return report(result, scenario, console)


def lab(path: Path, out: Path | None, console: Console) -> int:
    scenario = load_checked(path)
    folder = output_folder(out or next_folder(scenario.name))
    return report(runner.lab(scenario, folder, console), scenario, console)


def measure_again(folder: Path, console: Console) -> int:
    """From the copies a run left beside its log."""
    header = load_header(folder)
    scenario = load_scenario(existing_file(folder / "scenario.yaml", "scenario"), robot=folder)
    result = RunResult(folder, header.get("mode", "unknown"))
    result.recorder = {"lost": header.get("recorder_lost", {})}
    return report(result, scenario, console)


def report(result: RunResult, scenario: Scenario, console: Console) -> int:
    """Measures the log, leaves summary.json, prints it; the exit code says whether all is in
    tolerance.
    """
    summary, _ = summarize(result, scenario)
    console.print(summary.table(f"{scenario.name} on {scenario.robot.name}, {result.mode}"))
    console.print(f"log and summary: {result.folder}", highlight=False, soft_wrap=True)
    return OK if summary.passed else OUT_OF_TOLERANCE


def summarize(result: RunResult, scenario: Scenario) -> tuple[Summary, list]:
    log = Log(result.log)
    lost = result.recorder.get("lost", {})
    summary, pushes = measure(log, scenario, result.mode, lost)
    if len(log.read("JOINT_STATE")) == 0:
        raise InputError(f"{result.log} holds no JOINT_STATE: the driver never came up")
    summary.header["recorder_lost"] = {name: count for name, count in lost.items() if count}
    if result.stopped_early:
        summary.header["stopped_early"] = True
    summary.save(result.folder / "summary.json")
    return summary, pushes
