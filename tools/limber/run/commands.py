"""The commands run, lab and measure: check the scenario, run it, measure the log, print."""

import re
from pathlib import Path

from rich.console import Console

from limber.errors import OK, OUT_OF_TOLERANCE, InputError
from limber.live import network
from limber.log.reader import Log, log_file
from limber.measure.results import Summary, load_header
from limber.measure.summarize import measure
from limber.model.scenario import Scenario, load_scenario, scenario_beside
from limber.paths import robot_folder, run_folder
from limber.run import buses, runner
from limber.run.drive_words import with_words
from limber.run.options import FinishedRun, RunOptions


def next_folder(name: str, inside: Path = Path("out")) -> Path:
    """inside/NAME-<n> with the lowest n above all that are there."""
    taken = [re.fullmatch(rf"{re.escape(name)}-(\d+)", path.name) for path in inside.glob("*")]
    number = 1 + max((int(match[1]) for match in taken if match), default=0)
    return inside / f"{name}-{number}"


def _load(path: Path, robot: str | None, console: Console) -> Scenario:
    scenario = load_scenario(path, None if robot is None else robot_folder(robot))
    for line in scenario.warnings:
        console.print(
            f"warning: {line}", style="yellow", markup=False, highlight=False, soft_wrap=True
        )
    if scenario.notes:
        count = "1 note" if len(scenario.notes) == 1 else f"{len(scenario.notes)} notes"
        line = f"{count} on {scenario.robot.folder}: limber check {robot or path} lists them"
        console.print(line, style="dim", markup=False, highlight=False, soft_wrap=True)
    return scenario


def run(path: Path, options: RunOptions, console: Console) -> int:
    scenario = _load(path, options.robot, console)
    addresses = buses.addresses(scenario.robot, options.buses)
    buses.warn_of_motion(addresses, options.with_simulator, console)
    if options.page:
        network.require_shared_network(options.private_network, "the ports that a browser opens")
    elif buses.real(addresses):
        network.require_shared_network(options.private_network)
    else:
        network.ensure_multicast(options.private_network)
    folder = run_folder(options.out or next_folder(scenario.name))
    return report(runner.run(scenario, folder, options, console), scenario, console)


def lab(path: Path, options: RunOptions, console: Console) -> int:
    scenario = _load(path, options.robot, console)
    folder = run_folder(options.out or next_folder(scenario.name))
    finished = runner.lab(scenario, folder, console, options.record_can, options.log_name)
    return report(finished, scenario, console)


def measure_again(folder: Path, run: int | None, console: Console) -> int:
    """From the copies of robot and scenario beside the log; of several runs in it the last, unless
    one is named.
    """
    header = load_header(folder)
    scenario = scenario_beside(folder)
    if scenario is None:
        raise InputError(f"no scenario.yaml lies beside the log in {folder}")
    finished = FinishedRun(
        folder, header.get("mode", "unknown"), header.get("stopped_early", False)
    )
    finished.log_name = log_file(folder).name
    finished.recorder = {
        "lost": header.get("recorder_lost", {}),
        "dropped": header.get("recorder_dropped", 0),
    }
    return report(finished, scenario, console, run)


def report(
    finished: FinishedRun, scenario: Scenario, console: Console, run: int | None = None
) -> int:
    """Measures the log, writes summary.json and prints it; returns the exit code."""
    if not finished.recorded:
        ending = "stopped by you" if finished.stopped_early else "ended"
        console.print(f"{scenario.name} {ending}; not recorded, so nothing is measured.")
        return OK
    summary, _ = summarize(finished, scenario, run)
    if "run" in summary.header:
        told = f"{summary.header['run']} is measured; --run chooses another"
        console.print(f"{finished.log}: {told}", soft_wrap=True)
    console.print(summary.table(f"{scenario.name} on {scenario.robot.name}, {finished.mode}"))
    show_faults(summary, finished.folder, console)
    console.print(f"log and summary: {finished.folder}", soft_wrap=True)
    return OK if summary.passed else OUT_OF_TOLERANCE


def show_faults(summary: Summary, folder: Path, console: Console) -> None:
    """The story of each, and where the last seconds before it are kept."""
    for fault in summary.faults:
        title, *lines = fault.lines()
        console.print(title, style="bold red", markup=False, highlight=False, soft_wrap=True)
        for line in lines:
            console.print(line, markup=False, highlight=False, soft_wrap=True)
    boxes = _boxes(folder) if summary.faults else []
    if boxes:
        console.print(
            f"The last seconds of {len(boxes)} processes are kept: "
            f"limber log black-box show {boxes[0]}",
            soft_wrap=True,
        )


def _boxes(folder: Path) -> list[str]:
    """The black boxes that the processes' logs name; none in lock step."""
    logs = [path.read_text(encoding="utf-8") for path in sorted(folder.glob("limber-*.log"))]
    return [
        name
        for text in logs
        for name in re.findall(r"for `limber log black-box`: (\S+\.box)", text)
    ]


def summarize(
    finished: FinishedRun, scenario: Scenario, run: int | None = None
) -> tuple[Summary, list]:
    log, several = Log(finished.log).one_run(run)
    lost = finished.recorder.get("lost", {})
    dropped = finished.recorder.get("dropped", 0)
    summary, pushes = measure(
        log, scenario, finished.mode, lost, finished.stopped_early, recorder_dropped=dropped
    )
    if len(log.read("JOINT_STATE")) == 0:
        raise InputError(f"{finished.log} holds no JOINT_STATE: the driver never came up")
    summary.faults = with_words(summary.faults, finished.folder)
    if several:
        summary.header["run"] = several
    summary.header["recorder_lost"] = {name: count for name, count in lost.items() if count}
    if dropped:
        summary.header["recorder_dropped"] = dropped
    if finished.stopped_early:
        summary.header["stopped_early"] = True
    summary.save(finished.folder / "summary.json")
    return summary, pushes
