"""`limber demo`: pushes a simulated arm on a CAN bus and shows its measured stiffness."""

import math
from pathlib import Path

from rich.console import Console
from rich.table import Table

from limber import tables
from limber.errors import OK, OUT_OF_TOLERANCE
from limber.live import network
from limber.log.reader import Log
from limber.measure.pushes import MeasuredPush
from limber.measure.results import Result, Summary, text
from limber.model.scenario import Scenario
from limber.model.validation import load_checked
from limber.paths import ROOT, output_folder
from limber.run import commands, runner
from limber.run.options import RunOptions

SCENARIO = ROOT / "scenarios" / "demo.yaml"
SHOWN = (
    "peak contact force",
    "static contact force",
    "cycles",
    "cycles without an answer",
    "late cycles",
    "overruns",
    "messages lost",
    "requests refused",
    "faults",
    "realtime granted",
)
TOO_BUSY = (
    "[yellow]The loop was interrupted for too long and the driver stopped the arm, as it should.\n"
    "Was the machine busy? limber demo --lockstep needs no clock; limber doctor names cures.[/]"
)


def demo(seconds: float | None, options: RunOptions, console: Console) -> int:
    scenario = load_checked(SCENARIO)
    if seconds is not None:
        scenario.duration_s = seconds
    network.ensure_multicast(options.private_network)
    folder = output_folder(options.out or commands.next_folder("demo"))
    console.print(
        f"A simulated {scenario.robot.name} on a CAN bus; driver and controller as for a real arm. "
        f"{scenario.duration_s:g} s, {'lock step' if options.lockstep else 'realtime'}."
    )
    result = runner.run(scenario, folder, options, console)
    summary, pushes = commands.summarize(result, scenario)
    _show(summary, pushes, scenario, console)
    picture = _picture(result.log, scenario, pushes, folder)
    files = {
        picture: "the demo in one picture",
        folder / "summary.json": "all numbers",
        result.log: f"all messages; draw them with: limber plot {folder}",
    }
    for path, what in files.items():
        console.print(f"{path}  [dim]{what}[/]", soft_wrap=True)
    return OK if summary.passed else OUT_OF_TOLERANCE


def _picture(log: Path, scenario: Scenario, pushes: list[MeasuredPush], folder: Path) -> Path:
    from limber.run import demo_picture  # matplotlib takes a second to load

    path = folder / "demo.png"
    demo_picture.save(Log(log), scenario, pushes, path)
    return path


def _show(
    summary: Summary, pushes: list[MeasuredPush], scenario: Scenario, console: Console
) -> None:
    if pushes:
        console.print(_stiffness_table(pushes, scenario.tolerances.stiffness, summary))
    for name in SHOWN:
        result = summary.find(name)
        if result is not None:
            console.print(_line(result))
    faults = summary.find("faults")
    if summary.header["mode"] == "realtime" and faults is not None and faults.passed is False:
        console.print(TOO_BUSY)
    commands.show_faults(summary, console)
    wrong = [result for result in summary.results if result.passed is False]
    for result in wrong:
        console.print(f"[bold red]out of tolerance:[/] {_line(result)}")


def _stiffness_table(pushes: list[MeasuredPush], tolerance: float, summary: Summary) -> Table:
    numbers = ("force", "moved", "felt", "friction", "band", "less friction", "expected", "")
    columns = ["<push", *(f">{name}" for name in numbers)]
    table = tables.table(*columns, title="How soft is the tip?", padding=(0, 1, 0, 0))
    for measured in pushes:
        force, unit = ("N m", "N m/rad") if measured.angular else ("N", "N/m")
        moved = measured.moved * (180 / math.pi if measured.angular else 1e3)
        value = measured.stiffness_without_friction
        good = abs(value - measured.expected) <= tolerance * measured.expected
        table.add_row(
            measured.axis,
            f"{measured.force:.1f} {force}",
            f"{moved:.2f} {'°' if measured.angular else 'mm'}",
            f"{measured.stiffness:.1f} {unit}",
            f"{measured.friction_took:.2f} {force}",
            f"±{measured.friction_bound:.2f}",
            f"{value:.1f} {unit}",
            f"{measured.expected:.1f} {unit}",
            "after the fault" if summary.disturbed(measured.span) else tables.verdict(good),
        )
    return table


def _line(result: Result) -> str:
    expected = f" (predicted {result.expected:.4g})" if isinstance(result.expected, float) else ""
    note = f"  [dim]{result.note}[/]" if result.note else ""
    return f"{result.name}: {text(result.value)} {result.unit}{expected}{note}"
