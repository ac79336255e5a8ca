"""`limber dev soak --realtime`: the real processes for hours, and how late their cycles start.

A stop (the drives leave ON, or the controller leaves ACTIVE) is acknowledged as an operator would,
and the arm is used further. It has a cause if the machine stood still before it; see
machine_pauses.py. limber must not stop for any other reason, and must come back.
"""

import json
import subprocess
import time
from contextlib import ExitStack, suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from limber import messages, tables
from limber.errors import OK, OUT_OF_TOLERANCE, RunError
from limber.live import network
from limber.live.arm import Arm
from limber.live.arm_errors import FaultError, RefusedError, StackLostError, WaitTimeoutError
from limber.live.line import Line
from limber.model.robot import Robot, load_robot
from limber.paths import output_folder, program
from limber.problems import problem
from limber_qa.machine_pauses import Pause, Watchers, stood_still_s
from limber_qa.realtime_soak_picture import draw

START_S = 10.0  # at most, until the drives are enabled
PAUSE_S = 2.0  # between two goals
REACH_RAD = 0.2  # of a joint, from home
UNANSWERED_S = 60.0  # at most; this program has no priority, and waits for a busy machine, too
BACK_S = 10.0  # at most, from a stop until the arm is in use again
BEFORE_S = 1.0  # a stop follows what caused it within this time: the driver counts over a second
ENOUGH_S = 0.05  # of it: the driver bridges 50 cycles on virtual buses
LATENESS = ("lateness_p50_ns", "lateness_p99_ns", "lateness_p999_ns", "lateness_max_ns")
PROGRAMS = ("limber-sim", "limber-controller", "limber-driver")


@dataclass
class Stop:
    """`at_s`: of the run; `machine_stood_still_s`: in the second before."""

    at_s: float
    code: str
    machine_stood_still_s: float = 0.0
    back_after_s: float | None = None

    def violation(self) -> str:
        """What must not be; "" for a stop with a cause, after which the arm came back."""
        where = f"after {self.at_s:.1f} s: {self.code}"
        if self.back_after_s is None or self.back_after_s > BACK_S:
            return f"{where}: the arm did not come back within {BACK_S:g} s"
        if self.machine_stood_still_s < ENOUGH_S:
            still_ms = 1e3 * self.machine_stood_still_s
            return f"{where}: the machine stood still for {still_ms:.1f} ms only"
        return ""


@dataclass
class Watch:
    """What the driver tells of itself. `rows`: CLOCK_MONOTONIC, s; LATENESS, us."""

    rows: list[list[float]] = field(default_factory=list)
    last: Any = None
    state: Any = None
    left_on_s: float | None = None  # CLOCK_MONOTONIC, since when the drives are not ON

    def on_status(self, _channel: str, data: bytes) -> None:
        self.last = messages.view("driver_status_t", data)
        lateness_us = [1e-3 * float(self.last[name]) for name in LATENESS]
        self.rows.append([time.monotonic(), *lateness_us])

    def on_state(self, _channel: str, data: bytes) -> None:
        self.state = messages.view("joint_state_t", data)
        if self.drives_on:
            self.left_on_s = None
        elif self.left_on_s is None:
            self.left_on_s = time.monotonic()

    @property
    def drives_on(self) -> bool:
        return bool(self.state["drive_state"] == messages.message_class("joint_state_t").DRIVE_ON)


def run(name: str, hours: float, seed: int, out: Path, console: Console) -> int:
    """0 if nothing happened without a cause; writes lateness.json and lateness.png."""
    network.ensure_multicast(False)
    robot, folder = load_robot(name), output_folder(out)
    watch = Watch()
    bus = Line(messages.user_plane_url())
    bus.subscribe("DRIVER_STATUS", watch.on_status)
    bus.subscribe("JOINT_STATE", watch.on_state)
    with ExitStack() as stack:
        watchers = stack.enter_context(Watchers(folder))
        children = [stack.enter_context(started(name, robot, folder)) for name in PROGRAMS]
        for child in children:
            stack.callback(child.terminate)
        _listen(bus, START_S / 2)
        arm = stack.enter_context(Arm())
        begin_s = time.monotonic()
        use = _Use(arm, bus, watch, watchers, children, begin_s)
        use.run(hours, seed, robot, console)
        pauses = [pause for pause in watchers.pauses() if pause.start_s >= begin_s]
    return _report(watch, use, pauses, folder, console)


def started(name: str, robot: Robot, folder: Path) -> subprocess.Popen:
    with open(folder / f"{name}.log", "w", encoding="utf-8") as log:
        command = [str(program(name)), "--robot", str(robot.folder)]
        return subprocess.Popen(command, stdout=log, stderr=log, stdin=subprocess.DEVNULL)


def _listen(bus: Line, seconds: float) -> None:
    end = time.monotonic() + seconds
    while (left_ms := round(1e3 * (end - time.monotonic()))) > 0:
        bus.handle_timeout(left_ms)


@dataclass
class _Use:
    """The arm in use: goals at random, and back to work after each stop."""

    arm: Arm
    bus: Line
    watch: Watch
    watchers: Watchers
    children: list[subprocess.Popen]
    begin_s: float  # CLOCK_MONOTONIC
    stops: list[Stop] = field(default_factory=list)
    unanswered: int = 0  # requests
    end: str = ""  # why before the time

    def run(self, hours: float, seed: int, robot: Robot, console: Console) -> None:
        random, answered_s = np.random.default_rng(seed), self.begin_s
        low, high = ([getattr(j, end) for j in robot.joints] for end in ("low", "high"))
        self._activate()
        end_s = self.begin_s + 3600 * hours
        with console.status("soak") as status:
            while time.monotonic() < end_s:
                goal = robot.home + random.uniform(-REACH_RAD, REACH_RAD, len(robot.home))
                try:
                    self._follow(np.clip(goal, low, high))
                    answered_s = time.monotonic()
                except StackLostError as error:
                    self.unanswered += 1
                    if time.monotonic() > answered_s + UNANSWERED_S:
                        self.end = f"no request was answered for {UNANSWERED_S:g} s: {error}"
                    _listen(self.bus, PAUSE_S)
                if self.end or (self.stops and self.stops[-1].back_after_s is None):
                    return
                left_min = (end_s - time.monotonic()) / 60
                status.update(f"{left_min:.1f} minutes left, {len(self.stops)} stops")

    def _follow(self, goal: np.ndarray) -> None:
        with suppress(FaultError, RefusedError):  # a stop that is seen below
            self.arm.set_goal(joints_rad=goal, duration_s=PAUSE_S)
        _listen(self.bus, PAUSE_S)
        pairs = zip(PROGRAMS, self.children, strict=True)
        dead = [name for name, child in pairs if child.poll() is not None]
        if dead:
            self.end = f"{dead[0]} ended by itself: see its log"
        elif not self.watch.drives_on or self.arm.mode != "active":
            self.stops.append(self._stopped())

    def _activate(self) -> None:
        self.arm.activate()
        self.arm.gains(law="joint_impedance")

    def _stopped(self) -> Stop:
        """Notes why, and brings the arm back to work."""
        at_s = self.watch.left_on_s or time.monotonic()
        still_s = stood_still_s(self.watchers.pauses(), at_s - BEFORE_S, at_s)
        cause = problem("driver", self.watch.state["fault"])
        code = cause.code if cause else f"controller in {self.arm.mode}"
        stop = Stop(at_s - self.begin_s, code, still_s)
        begin_s = time.monotonic()
        while time.monotonic() < begin_s + BACK_S:
            with suppress(FaultError, RefusedError, StackLostError, WaitTimeoutError):
                if self.arm.mode in ("fault", "estop"):
                    self.arm.acknowledge()
                self._activate()
                _listen(self.bus, 0.1)
                stop.back_after_s = time.monotonic() - begin_s
                break
            _listen(self.bus, 0.1)
        return stop


def _report(watch: Watch, use: _Use, pauses: list[Pause], folder: Path, console: Console) -> int:
    if watch.last is None:
        raise RunError(f"no DRIVER_STATUS was received: see {folder / 'limber-driver.log'}")
    last = watch.last
    report: dict[str, Any] = {
        name: int(last[name])
        for name in ("cycles", "late_cycles", "overrun_cycles", "commands_missing")
    }
    report |= {name.replace("_ns", "_us"): round(1e-3 * int(last[name]), 1) for name in LATENESS}
    report["requests_unanswered"] = use.unanswered
    report["machine_stood_still_ms"] = {
        "times": len(pauses),
        "longest": round(1e3 * max((p.length_s for p in pauses), default=0.0), 1),
        "in_all": round(1e3 * sum(p.length_s for p in pauses)),
    }
    report["stops"] = [asdict(stop) for stop in use.stops]
    report["violations"] = [text for stop in use.stops if (text := stop.violation())]
    report["violations"] += [use.end] if use.end else []
    (folder / "lateness.json").write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")
    draw(np.asarray(watch.rows), use.stops, pauses, use.begin_s, folder / "lateness.png")
    console.print(_table(report))
    for violation in report["violations"]:
        console.print(f"[bold red]{violation}[/]")
    console.print(f"report and picture: {folder}", soft_wrap=True)
    return OUT_OF_TOLERANCE if report["violations"] else OK


def _table(report: dict[str, Any]) -> Any:
    table = tables.table("<", ">", title="soak in real time")
    for name, value in report.items():
        if not isinstance(value, list | dict):
            table.add_row(name.replace("_", " "), str(value))
    still = report["machine_stood_still_ms"]
    text = f"{still['times']} times, {still['longest']} ms at most, {still['in_all']} ms in all"
    table.add_row("machine stood still (1 ms and more)", text)
    for stop in report["stops"]:
        back_s = stop["back_after_s"]
        table.add_row(
            f"stop after {stop['at_s']:.0f} s",
            f"{stop['code']}; the machine had stood still for "
            f"{1e3 * stop['machine_stood_still_s']:.0f} ms of a second; "
            + ("not back" if back_s is None else f"back after {back_s:.1f} s"),
        )
    return table
