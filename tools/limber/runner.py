"""Runs a scenario: starts the processes, follows them, stops them, leaves a folder of it all."""

import contextlib
import json
import shutil
import signal
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from rich.console import Console

from limber.display import Display
from limber.errors import InputError, RunError
from limber.listen import somebody_drives
from limber.paths import program
from limber.processes import Child, ProcessGroup
from limber.scenario import Scenario

LOG_NAME = "run.lcmlog"
START_TIMEOUT_S = 10.0
STOP_TIMEOUT_S = 5.0


@dataclass
class RunResult:
    folder: Path
    mode: str
    stopped_early: bool = False
    recorder: dict = field(default_factory=dict)

    @property
    def log(self) -> Path:
        return self.folder / LOG_NAME


@dataclass(frozen=True)
class RunOptions:
    lockstep: bool
    buses: tuple[str, ...] = ()
    with_simulator: bool = True
    watch: bool = False  # show the arm live, not only how far the run is


def run(scenario: Scenario, folder: Path, options: RunOptions, console: Console) -> RunResult:
    """The three processes and a recorder. Ctrl-C ends the run in good order, the log stays."""
    if somebody_drives():
        raise RunError(
            "another driver is publishing on this machine: stop it, or run beside it with --private"
        )
    commands = _commands(scenario, folder, options)
    copy_inputs(scenario, folder)
    result = RunResult(folder, "lockstep" if options.lockstep else "realtime")
    with ProcessGroup(folder) as group, _sigterm_as_interrupt():
        for name, command in commands.items():
            _start(group, name, command)
        code = _follow(group, Display(scenario, console, options.watch), result)
        if code != 0 and not result.stopped_early:
            raise group.children["limber-driver"].failure()
        result.recorder = _stop_others(group)
    return result


def lab(scenario: Scenario, folder: Path, console: Console) -> RunResult:
    """The whole stack in one process, in lock step, as fast as the processor allows."""
    copy_inputs(scenario, folder)
    result = RunResult(folder, "lab")
    path = str(scenario.path)
    command = [str(program("limber-lab")), path, "--log", str(result.log), "--progress"]
    with ProcessGroup(folder) as group, _sigterm_as_interrupt():
        child = group.start("limber-lab", command)
        with console.status(f"{scenario.name} in the lab") as status:
            code = group.run_until("limber-lab", lambda: status.update(_said_last(child)))
        if code != 0:
            raise child.failure()
    console.print(_said_last(child), highlight=False)
    return result


def copy_inputs(scenario: Scenario, folder: Path) -> None:
    """The scenario and the robot as they were: a log without them cannot be understood later."""
    shutil.copyfile(scenario.path, folder / "scenario.yaml")
    shutil.copyfile(scenario.robot.folder / "robot.yaml", folder / "robot.yaml")
    shutil.copyfile(scenario.robot.urdf, folder / scenario.robot.urdf.name)


def _said_last(child: Child) -> str:
    lines = child.last_lines(1)
    return lines[0].strip() if lines else "starting"


def check_buses(scenario: Scenario, buses: tuple[str, ...]) -> None:
    """Refuses NAME=ADDR that names no bus of the robot or no address that could be one."""
    known = scenario.robot.buses
    for text in buses:
        name, _, address = text.partition("=")
        if name not in known:
            raise InputError(f"--bus {text}: the robot's buses are {', '.join(known)}")
        if not address.startswith(("socketcan:", "virtual:")):
            raise InputError(f"--bus {text}: write {name}=socketcan:IFACE or {name}=virtual:NAME")


def _commands(scenario: Scenario, folder: Path, options: RunOptions) -> dict[str, list[str]]:
    """Program -> command line in the order of starting: the driver, the clock, is last."""
    lockstep = ["--lockstep"] if options.lockstep else []
    buses = [word for bus in options.buses for word in ("--bus", bus)]
    path, robot = str(scenario.path), str(scenario.robot.folder)
    duration = ["--duration", f"{scenario.duration_s:.9g}"]
    if options.lockstep:
        duration = ["--cycles", str(round(scenario.duration_s * scenario.robot.rate_hz))]
    commands = {"limber-record": ["--out", str(folder / LOG_NAME)]}
    pace = "--lockstep" if options.lockstep else "--realtime"  # whatever the scenario says
    if options.with_simulator:
        commands["limber-sim"] = ["--scenario", path, *buses, pace]
    commands["limber-controller"] = ["--scenario", path, "--robot", robot, pace]
    commands["limber-driver"] = ["--robot", robot, *buses, *lockstep, *duration]
    return {name: [str(program(name)), *words] for name, words in commands.items()}


def _start(group: ProcessGroup, name: str, command: list[str]) -> None:
    """The next program starts when this one has said that it is ready (its first line)."""
    child = group.start(name, command)
    if name != "limber-driver":
        group.wait_for_line(child, "\n", START_TIMEOUT_S)


def _follow(group: ProcessGroup, display: Display, result: RunResult) -> int:
    """Shows the run until the driver ends, or ends it on Ctrl-C; returns its exit code."""
    try:
        with display:
            return group.run_until("limber-driver", display.update)
    except KeyboardInterrupt:
        result.stopped_early = True
        return group.stop("limber-driver", signal.SIGINT, STOP_TIMEOUT_S)


def _stop_others(group: ProcessGroup) -> dict:
    """Ends the rest, the recorder last, so that it hears everything; returns its report."""
    for name in ("limber-controller", "limber-sim"):
        if name in group.children:
            group.stop(name, signal.SIGTERM, STOP_TIMEOUT_S)
    recorder = group.children["limber-record"]
    if group.stop("limber-record", signal.SIGINT, 2 * STOP_TIMEOUT_S) != 0:
        raise recorder.failure()
    try:
        return json.loads(recorder.last_lines(1)[0])
    except (IndexError, json.JSONDecodeError) as error:
        raise RunError(f"limber-record left no report: see {recorder.log}") from error


@contextlib.contextmanager
def _sigterm_as_interrupt() -> Iterator[None]:
    """`kill` ends a run as Ctrl-C does: the arm first, the log last."""

    def interrupt(_number: int, _frame: object) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
