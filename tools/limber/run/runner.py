"""Runs a scenario: starts the processes, watches them, stops them, leaves a folder of results."""

import json
import re
import signal
import sys
from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

from rich.console import Console

from limber.errors import RunError
from limber.live.receiver import driver_is_running
from limber.model.scenario import Scenario, keep_scenario
from limber.paths import program
from limber.run.display import display
from limber.run.options import CAN_LOG_NAME, LOG_NAME, FinishedRun, RunOptions
from limber.run.pace import Pace, choose
from limber.run.processes import Child, ProcessGroup, process_group, sigterm_as_interrupt

START_TIMEOUT_S = 10.0
STOP_TIMEOUT_S = 5.0
DRIVER, LAB = "limber-driver", "limber-lab"  # the clock: a run is over when it ends
TELLERS = (DRIVER, "limber-controller", "limber-sim", LAB)
BEHIND = re.compile(r"simulated time runs at \d+ % of real time")  # in all of one process' words
MONITOR = "limber-monitor"
RECORDERS = ("limber-record", "limber-can")
LISTENERS = (*RECORDERS, MONITOR)  # never a reason to stop an arm


def run(scenario: Scenario, folder: Path, options: RunOptions, console: Console) -> FinishedRun:
    """The three processes and a recorder, or all in one. Ctrl-C ends the run in good order, the
    log stays.
    """
    if driver_is_running():
        raise RunError(
            "another driver is publishing on this machine: stop it, or run beside it with --private"
        )
    pace = choose(scenario, options)
    recorded = scenario.record if options.record is None else options.record
    commands = _commands(scenario, folder, options, pace, recorded)
    keep_scenario(scenario, folder)
    result = FinishedRun(folder, str(pace), recorded=recorded, log_name=options.log_name)
    with process_group(folder) as group, sigterm_as_interrupt():
        for name, command in commands.items():
            _start(group, name, [*command, *_readers(group, name, pace)], console)
        clock = group.children[list(commands)[-1]]
        shown = display(scenario, result.log, console, options.live_view)
        code = _follow(group, clock.name, shown, result, options, console)
        _tell(group, console, quiet=bool(result.behind))
        if code != 0 and not (result.stopped_early or result.behind):
            raise clock.failure()
        result.recorder = _stop_others(group)
    return result


def lab(
    scenario: Scenario,
    folder: Path,
    console: Console,
    record_can: bool = False,
    log_name: str = LOG_NAME,
) -> FinishedRun:
    """The whole stack in one process, in lock step, as fast as the processor allows."""
    keep_scenario(scenario, folder)
    result = FinishedRun(folder, "lab", log_name=log_name)
    words = _scenario_words(scenario)
    command = [str(program("limber-lab")), *words, "--log", str(result.log), "--progress"]
    if record_can:
        command += ["--can", str(result.can_log)]
    with process_group(folder) as group, sigterm_as_interrupt():
        child = group.start("limber-lab", command)
        with console.status(f"{scenario.name} in the lab") as status:
            code = group.run_until("limber-lab", lambda: status.update(_last_line(child)))
        if code != 0:
            raise child.failure()
        _tell(group, console)
    console.print(_last_line(child))
    return result


def _last_line(child: Child) -> str:
    lines = child.last_lines(1)
    return lines[0].strip() if lines else "starting"


def _commands(
    scenario: Scenario, folder: Path, options: RunOptions, pace: Pace, recorded: bool
) -> dict[str, list[str]]:
    """Program -> command line in the order of starting: the clock, driver or lab, is last."""
    started = {
        name: [str(program(name)), *words]
        for name, words in (
            {LAB: _lab_words(scenario, folder, options, pace, recorded)}
            if options.one_process
            else _process_words(scenario, folder, options, pace, recorded)
        ).items()
    }
    if pace == Pace.LOCKSTEP:  # as fast as the processors allow, but whoever records comes first
        for name in started.keys() - set(RECORDERS):
            started[name] = ["nice", "-n", "10", *started[name]]
    if options.page:
        path, robot = str(scenario.path), str(scenario.robot.folder)
        started = {MONITOR: _monitor(path, robot, options.with_simulator), **started}
    return started


def _scenario_words(scenario: Scenario) -> list[str]:
    return [str(scenario.path), "--robot", str(scenario.robot.folder)]


def _length_words(scenario: Scenario, options: RunOptions, pace: Pace) -> list[str]:
    rate = [] if options.rate_hz is None else ["--rate", f"{options.rate_hz:.9g}"]
    if pace == Pace.REALTIME:
        return [*rate, "--duration", f"{scenario.duration_s:.9g}"]
    rate_hz = options.rate_hz or scenario.robot.rate_hz
    return [*rate, "--cycles", str(round(scenario.duration_s * rate_hz))]


def _lab_words(
    scenario: Scenario, folder: Path, options: RunOptions, pace: Pace, recorded: bool
) -> list[str]:
    """It writes the log itself: no recorder has to keep up."""
    words = [*_scenario_words(scenario), "--live", *["--paced"] * (pace == Pace.PACED)]
    words += ["--log", str(folder / options.log_name)] * recorded
    words += ["--can", str(folder / CAN_LOG_NAME)] * options.record_can
    return words + _length_words(scenario, options, pace)


def _process_words(
    scenario: Scenario, folder: Path, options: RunOptions, pace: Pace, recorded: bool
) -> dict[str, list[str]]:
    buses = [word for bus in options.buses for word in ("--bus", bus)]
    path, robot = str(scenario.path), str(scenario.robot.folder)
    rate = [] if options.rate_hz is None else ["--rate", f"{options.rate_hz:.9g}"]
    commands: dict[str, list[str]] = {}
    if recorded:
        commands["limber-record"] = ["--out", str(folder / options.log_name)]
    if options.record_can:
        can_log = str(folder / CAN_LOG_NAME)
        commands["limber-can"] = ["record", robot, "--out", can_log, *buses]
    if options.with_simulator:
        played = ["--scenario", path, "--robot", robot]
        commands["limber-sim"] = [*played, *buses, *rate, pace.option]
    commands["limber-controller"] = ["--scenario", path, "--robot", robot, pace.option]
    length = _length_words(scenario, options, pace)
    commands[DRIVER] = ["--robot", robot, *buses, *length, pace.option]
    return commands


def _monitor(scenario: str, robot: str, simulated: bool) -> list[str]:
    """The page may move simulated arms only; a real one by `limber monitor --control`."""
    command = [sys.executable, "-m", "limber", "monitor", "--robot", robot, "--scenario", scenario]
    return [*command, *(["--control"] if simulated else [])]


def _start(group: ProcessGroup, name: str, command: list[str], console: Console) -> None:
    """Waits until the program is ready, which its first line of output shows."""
    child = group.start(name, command, spared=name in LISTENERS)
    if name not in (DRIVER, LAB):
        group.wait_for_line(child, "\n", START_TIMEOUT_S)
    if name == MONITOR:
        for line in child.last_lines(2):  # its address
            console.print(line, markup=False, soft_wrap=True)


def _readers(group: ProcessGroup, name: str, pace: Pace) -> list[str]:
    """Without a clock the driver waits for those that record."""
    recorders = [str(group.children[n].process.pid) for n in RECORDERS if n in group.children]
    waits = name == DRIVER and pace == Pace.LOCKSTEP and recorders
    return ["--wait-for", ",".join(recorders)] if waits else []


def _follow(
    group: ProcessGroup,
    clock: str,
    display: AbstractContextManager[Callable[[], None]],
    result: FinishedRun,
    options: RunOptions,
    console: Console,
) -> int:
    """Shows the run until the clock ends, or ends it on Ctrl-C; returns its exit code."""
    try:
        with display as update:

            def tick() -> None:
                told = _tell(group, console, quiet=options.leave_when_behind)
                lagging = next((line for line in told if BEHIND.search(line)), "")
                if lagging and options.leave_when_behind:
                    result.behind = lagging
                    raise _LeftError
                for child in group.missed():
                    lost = f"{child.failure()}; the run goes on without it"
                    console.print(lost, style="bold red", markup=False, soft_wrap=True)
                update()

            return group.run_until(clock, tick)
    except _LeftError:
        return group.stop(clock, signal.SIGINT, STOP_TIMEOUT_S)
    except KeyboardInterrupt:
        result.stopped_early = True
        return group.stop(clock, signal.SIGINT, STOP_TIMEOUT_S)


class _LeftError(Exception):
    """The machine does not keep up, and the caller knows better."""


def _tell(group: ProcessGroup, console: Console, quiet: bool = False) -> list[str]:
    """What the user has to know now, not when he reads the logs; `quiet`: but for a lagging pace,
    which is left to the caller. Returns the lines.
    """
    told: list[str] = []
    for child in (group.children[name] for name in TELLERS if name in group.children):
        for line in child.news():
            told.append(line)
            if quiet and "% of real time" in line:
                continue
            console.print(line, style="yellow", highlight=False, markup=False, soft_wrap=True)
    return told


def _stop_others(group: ProcessGroup) -> dict[str, Any]:
    """Ends the rest, the recorder last, so that its log is complete; returns its report."""
    for name in (MONITOR, "limber-controller", "limber-sim"):
        if name in group.children:
            group.stop(name, signal.SIGTERM, STOP_TIMEOUT_S)
    for name, end in (("limber-can", signal.SIGTERM), ("limber-record", signal.SIGINT)):
        if name in group.children and group.stop(name, end, 2 * STOP_TIMEOUT_S) != 0:
            raise group.children[name].failure()
    recorder = group.children.get("limber-record")
    if recorder is None:
        return {}
    try:
        report: dict[str, Any] = json.loads(recorder.last_lines(1)[0])
    except (IndexError, json.JSONDecodeError) as error:
        raise RunError(f"limber-record left no report: see {recorder.log}") from error
    return report
