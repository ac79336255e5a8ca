"""`limber soak --realtime`: the real processes for hours, and how late their cycles start."""

import json
import subprocess
import time
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import lcm
import numpy as np
from rich.console import Console

from limber import messages, tables
from limber.errors import OK, OUT_OF_TOLERANCE, RunError
from limber.live import network
from limber.live.arm import Arm
from limber.model.robot import Robot, load_robot
from limber.paths import output_folder, program
from limber.problems import problem

START_S = 10.0  # at most, until the drives are enabled
PAUSE_S = 2.0  # between two goals
REACH_RAD = 0.2  # of a joint, from home
LATENESS = ("lateness_p50_ns", "lateness_p99_ns", "lateness_p999_ns", "lateness_max_ns")


@dataclass
class Watch:
    """What the driver tells of itself. `rows`: arm time in s, then LATENESS in microseconds."""

    rows: list[list[float]] = field(default_factory=list)
    last: Any = None
    state: Any = None

    def on_status(self, _channel: str, data: bytes) -> None:
        self.last = messages.view("driver_status_t", data)
        lateness_us = [1e-3 * float(self.last[name]) for name in LATENESS]
        self.rows.append([1e-9 * float(self.last["time_ns"]), *lateness_us])

    def on_state(self, _channel: str, data: bytes) -> None:
        self.state = messages.view("joint_state_t", data)


def run(name: str, hours: float, seed: int, out: Path, console: Console) -> int:
    """0 if the drives stayed on; writes lateness.json and lateness.png."""
    network.ensure_multicast(False)
    robot, folder = load_robot(name), output_folder(out)
    watch = Watch()
    bus = lcm.LCM(messages.user_plane_url())
    bus.subscribe("DRIVER_STATUS", watch.on_status)
    bus.subscribe("JOINT_STATE", watch.on_state).set_queue_capacity(1)
    with ExitStack() as stack:
        children = [stack.enter_context(started(name, robot, folder)) for name in PROGRAMS]
        stack.callback(lambda: [child.terminate() for child in children])
        _listen(bus, START_S / 2)
        arm = stack.enter_context(Arm())
        trip = _use(arm, bus, watch, children, hours, np.random.default_rng(seed), robot, console)
    return _report(watch, trip, folder, console)


PROGRAMS = ("limber-sim", "limber-controller", "limber-driver")


def started(name: str, robot: Robot, folder: Path) -> subprocess.Popen:
    with open(folder / f"{name}.log", "w", encoding="utf-8") as log:
        command = [str(program(name)), "--robot", str(robot.folder)]
        return subprocess.Popen(command, stdout=log, stderr=log, stdin=subprocess.DEVNULL)


def _listen(bus: lcm.LCM, seconds: float) -> None:
    end = time.monotonic() + seconds
    while (left_ms := round(1e3 * (end - time.monotonic()))) > 0:
        bus.handle_timeout(left_ms)


def _use(arm, bus, watch, children, hours, random, robot, console) -> str:
    """Goals at random until the time is over; why it ended before, or ""."""
    drive = messages.message_class("joint_state_t")
    arm.activate()
    arm.gains(law="joint_impedance")
    end = time.monotonic() + 3600 * hours
    with console.status("soak") as status:
        while time.monotonic() < end:
            goal = robot.home + random.uniform(-REACH_RAD, REACH_RAD, len(robot.home))
            low, high = ([getattr(j, end) for j in robot.joints] for end in ("low", "high"))
            arm.set_goal(joints_rad=np.clip(goal, low, high), duration_s=PAUSE_S)
            _listen(bus, PAUSE_S)
            dead = [child.args[0] for child in children if child.poll() is not None]
            if dead:
                return f"{Path(dead[0]).name} ended by itself"
            if watch.state is None:
                return "no JOINT_STATE"
            if watch.state["drive_state"] != drive.DRIVE_ON:
                cause = problem("driver", watch.state["fault"])
                return f"the drives left ON: {cause.code if cause else 'nobody knows why'}"
            status.update(f"{(end - time.monotonic()) / 60:.1f} minutes left")
    return ""


def _report(watch: Watch, trip: str, folder: Path, console: Console) -> int:
    if watch.last is None:
        raise RunError(f"the driver said nothing: see {folder / 'limber-driver.log'}")
    last = watch.last
    report = {name: int(last[name]) for name in ("cycles", "late_cycles", "overrun_cycles")}
    report |= {name.replace("_ns", "_us"): int(last[name]) / 1000 for name in LATENESS}
    report |= {"commands_missing": int(last["commands_missing"]), "trip": trip}
    (folder / "lateness.json").write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")
    _draw(np.asarray(watch.rows), folder / "lateness.png")
    table = tables.table("<", ">", title="soak in real time")
    for name, value in report.items():
        table.add_row(name.replace("_", " "), str(value) or "none")
    console.print(table)
    console.print(f"report and picture: {folder}", soft_wrap=True)
    return OUT_OF_TOLERANCE if trip else OK


def _draw(rows: np.ndarray, path: Path) -> None:
    """Lateness of the cycles so far: how the worst ones came together over the run."""
    from matplotlib import pyplot

    from limber.plot import style

    with pyplot.rc_context(style.STYLE):
        figure, ax = pyplot.subplots(figsize=(7, 3.5), layout="constrained")
        names = ("half of all cycles", "99 %", "99.9 %", "all")
        for column, (name, color) in enumerate(zip(names, style.COLORS, strict=False), 1):
            ax.semilogy(rows[:, 0] / 60, np.maximum(rows[:, column], 0.1), color=color, label=name)
        ax.set_ylim(bottom=5e-4)  # room for the legend
        style.name_axes(ax, "time of the run, min", "late by less than, µs", "lower center")
        figure.savefig(path, dpi=120)
        pyplot.close(figure)
