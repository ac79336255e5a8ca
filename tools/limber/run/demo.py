"""`limber demo`: pushes a simulated arm on a CAN bus and shows its measured stiffness."""

import math
from dataclasses import replace
from pathlib import Path

from rich.console import Console
from rich.table import Table

from limber import tables
from limber.errors import OK, OUT_OF_TOLERANCE
from limber.live import network
from limber.log.reader import Log
from limber.measure.pushes import MeasuredPush
from limber.measure.results import Result, Summary, text
from limber.model.scenario import Scenario, load_scenario
from limber.paths import SCENARIOS, run_folder
from limber.run import commands, runner
from limber.run.options import FinishedRun, RunOptions

SCENARIO = SCENARIOS / "demo.yaml"
WITH_SENSORS = SCENARIOS / "demo_sensors.yaml"
# Causes of a machine that was busy elsewhere for too long; in a simulation nothing else is late.
LATE = {
    "driver.CONTROLLER_LOST",
    "driver.OVERRUN",
    "driver.REPLY_LOST",
    "controller.STATE_LOST",
}
MEANING = (
    "Felt is pushed over moved: what a hand on the arm feels. Friction in the joints carried a\n"
    "part of the push. The rest of it over the distance is the spring alone: what was asked for."
)
DITHERED = (
    "With friction_compensation: dither the motors swing a little, the gears do not stick, and a\n"
    "hand feels what was asked for."
)
OBSERVED = (
    "Felt is pushed over moved: what a hand on the arm feels. Torque sensors behind the gears see\n"
    "their friction and the controller makes up for it: a hand feels what was asked for, but for\n"
    "what the bearings hold. Without such sensors: limber demo."
)


def demo(seconds: float | None, sensors: bool, options: RunOptions, console: Console) -> int:
    """`sensors`: with an arm that measures its joint torques."""
    scenario = load_scenario(WITH_SENSORS if sensors else SCENARIO)
    if seconds is not None:
        scenario.duration_s = seconds
    if options.page:
        network.require_shared_network(options.private_network, "the ports that a browser opens")
    network.ensure_multicast(options.private_network)
    console.print(
        f"A simulated {scenario.robot.name} on a CAN bus; driver and controller as for a real arm. "
        f"{scenario.duration_s:g} s of arm time."
    )
    finished = _run(scenario, options, console)
    summary, pushes = commands.summarize(finished, scenario)
    if _was_late(summary, finished):
        cause = summary.faults[0]
        console.print(
            f"[yellow]After {cause.time_s:.1f} s this machine was busy elsewhere for too long "
            f"({cause.problem.code}), and the driver stopped the arm, as it should "
            f"({finished.folder}).\nHere is the same with simulated time that waits for the "
            "machine; limber doctor names cures.[/]"
        )
        again = replace(options, out=_beside(options.out, "lockstep"), lockstep=None)
        finished = _run(scenario, again, console)
        summary, pushes = commands.summarize(finished, scenario)
    folder = finished.folder
    _show(summary, pushes, scenario, folder, console)
    picture = _picture(finished.log, scenario, pushes, folder)
    files = {
        picture: "the demo in one picture",
        folder / "summary.json": "all numbers",
        finished.log: f"all messages; draw them with: limber plot {folder}",
    }
    for path, what in files.items():
        console.print(f"{path}  [dim]{what}[/]", soft_wrap=True)
    return OK if summary.passed else OUT_OF_TOLERANCE


def _run(scenario: Scenario, options: RunOptions, console: Console) -> FinishedRun:
    """In one process, if the machine does not keep up with three."""
    folder = run_folder(options.out or commands.next_folder("demo"))
    finished = runner.run(scenario, folder, options, console)
    if not finished.behind or options.one_process:
        return finished
    share = runner.BEHIND.search(finished.behind)
    console.print(
        f"[yellow]With three processes {share[0] if share else 'it lags'}: each waits for its turn "
        f"on a busy machine ({folder}).\nHere is the same in one process (--one-process), which "
        "needs no turns.[/]"
    )
    out = _beside(options.out, "one-process")
    again = replace(options, out=out, one_process=True, leave_when_behind=False)
    return _run(scenario, again, console)


def _beside(out: Path | None, word: str) -> Path | None:
    """The folder of a second attempt."""
    return out and out.with_name(f"{out.name}-{word}")


def _was_late(summary: Summary, finished: FinishedRun) -> bool:
    """The run ended because of the machine, not of the arm or the user."""
    faults = summary.faults
    return (
        finished.mode == "realtime"
        and not finished.stopped_early
        and bool(faults)
        and all(fault.problem.code in LATE for fault in faults)
    )


def _picture(log: Path, scenario: Scenario, pushes: list[MeasuredPush], folder: Path) -> Path:
    from limber.run import demo_picture  # matplotlib takes a second to load

    path = folder / "demo.png"
    demo_picture.save(Log(log), scenario, pushes, path)
    return path


def _show(
    summary: Summary,
    pushes: list[MeasuredPush],
    scenario: Scenario,
    folder: Path,
    console: Console,
) -> None:
    if pushes:
        console.print(_stiffness_table(pushes, scenario.tolerances.stiffness, summary))
        console.print(_meaning(pushes, scenario))
        _show_rest(pushes, scenario, console)
    force = summary.find("peak contact force")
    if force is not None:
        rest = summary.find("static contact force")
        leaning = f", {rest.value:.1f} N leaning on it" if rest is not None else ""
        console.print(f"The wall was hit with {force.value:.1f} N at most{leaning}.")
    console.print(_health(summary), highlight=False)
    commands.show_faults(summary, folder, console)
    for result in summary.results:
        if result.passed is False:
            console.print(f"[bold red]out of tolerance:[/] {_line(result)}")


def _show_rest(pushes: list[MeasuredPush], scenario: Scenario, console: Console) -> None:
    """How far from where it was the hand stayed."""
    kept_mm = [measured.offset_after_m * 1e3 for measured in pushes if not measured.dithered]
    if not scenario.friction or not max(kept_mm, default=0.0) > 0.1:
        return
    dithered_mm = [measured.offset_after_m * 1e3 for measured in pushes if measured.dithered]
    console.print(
        f"Let go, the hand stayed up to {max(kept_mm):.0f} mm from where it was: there the spring "
        "pulls less than friction holds."
        + (f" With dither: up to {max(dithered_mm):.1f} mm." if dithered_mm else "")
    )


def _meaning(pushes: list[MeasuredPush], scenario: Scenario) -> str:
    if all(measured.friction_observed for measured in pushes):
        return OBSERVED
    if not scenario.friction:
        return MEANING.partition("Friction")[0].strip()
    dithered = any(measured.dithered for measured in pushes)
    return f"{MEANING}\n{DITHERED}" if dithered else MEANING


def _health(summary: Summary) -> str:
    """One line about the run itself."""
    parts = []
    for name, words in (
        ("cycles", "{} cycles"),
        ("late cycles", "{} started late"),
        ("messages lost", "{} messages lost"),
        ("requests refused", "{} requests refused"),
    ):
        result = summary.find(name)
        if result is not None:
            parts.append(words.format(text(result.value)))
    granted = summary.find("realtime granted")
    if granted is not None and not granted.value:
        parts.append("no real-time priority (limber doctor tells how to get it)")
    return "; ".join(parts) + "."


def _stiffness_table(pushes: list[MeasuredPush], tolerance: float, summary: Summary) -> Table:
    dithered = any(measured.dithered for measured in pushes)
    columns = ["<along", ">pushed", ">moved", ">felt", ">friction", ">spring alone", ">asked", ">"]
    columns[1:1] = ["<dither"] * dithered
    table = tables.table(*columns, title="How soft is the tip?", padding=(0, 1, 0, 0))
    for measured in pushes:
        force, unit = ("N m", "N m/rad") if measured.angular else ("N", "N/m")
        moved = measured.moved * (180 / math.pi if measured.angular else 1e3)
        value = measured.stiffness_without_friction
        good = abs(measured.judged - measured.expected) <= measured.allowed(tolerance)
        table.add_row(
            measured.axis,
            *["on" if measured.dithered else "off"] * dithered,
            f"{measured.force:.1f} {force}",
            f"{moved:.1f} {'°' if measured.angular else 'mm'}",
            f"{measured.stiffness:.0f} {unit}",
            f"{round(measured.friction_took, 1) + 0.0:.1f} {force}",  # never -0.0
            f"{value:.0f} {unit}",
            f"{measured.expected:.0f} {unit}",
            "after the fault" if summary.disturbed(measured.span) else tables.verdict(good),
        )
    return table


def _line(result: Result) -> str:
    expected = f" (predicted {result.expected:.4g})" if isinstance(result.expected, float) else ""
    note = f"  [dim]{result.note}[/]" if result.note else ""
    return f"{result.name}: {text(result.value)} {result.unit}{expected}{note}"
