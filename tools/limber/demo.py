"""`limber demo`: pushes a simulated arm on a CAN bus and shows how soft it turned out to be."""

import math
from pathlib import Path

from rich.console import Console
from rich.table import Table

from limber import jobs, network, runner
from limber.errors import OK, OUT_OF_TOLERANCE
from limber.logs import Log
from limber.paths import ROOT, output_folder
from limber.pushes import Measured
from limber.results import Result, Summary
from limber.runner import RunOptions
from limber.scenario import Scenario

SCENARIO = ROOT / "scenarios" / "demo.yaml"
SHOWN = (
    "peak contact force",
    "static contact force",
    "cycles",
    "cycles without an answer",
    "late cycles",
    "overruns",
    "messages lost",
    "faults",
    "realtime granted",
)
TOO_BUSY = (
    "[yellow]The loop was interrupted for too long and the driver stopped the arm, as it should. "
    "Was the machine busy?\nlimber demo --lockstep needs no clock; limber doctor says what would "
    "help.[/]"
)


def demo(
    out: Path | None, seconds: float | None, options: RunOptions, private: bool, console: Console
) -> int:
    scenario = jobs.load_checked(SCENARIO)
    if seconds is not None:
        scenario.duration_s = seconds
    network.ensure_multicast(private)
    folder = output_folder(out or jobs.next_folder("demo"))
    console.print(
        f"A simulated {scenario.robot.name} on a CAN bus; driver and controller as for a real arm. "
        f"{scenario.duration_s:g} s, {'lock step' if options.lockstep else 'realtime'}."
    )
    result = runner.run(scenario, folder, options, console)
    summary, pushes = jobs.summarize(result, scenario)
    _show(summary, pushes, scenario, console)
    picture = _picture(result.log, scenario, pushes, folder)
    files = {
        picture: "what happened, in one picture",
        folder / "summary.json": "all numbers",
        result.log: f"everything that was said; draw it with: limber plot {folder}",
    }
    for path, what in files.items():
        console.print(f"{path}  [dim]{what}[/]", highlight=False, soft_wrap=True)
    return OK if summary.passed else OUT_OF_TOLERANCE


def _picture(log: Path, scenario: Scenario, pushes: list[Measured], folder: Path) -> Path:
    from limber import demo_picture  # matplotlib takes a second to load

    path = folder / "demo.png"
    demo_picture.save(Log(log), scenario, pushes, path)
    return path


def _show(summary: Summary, pushes: list[Measured], scenario: Scenario, console: Console) -> None:
    if pushes:
        console.print(_stiffness_table(pushes, scenario.tolerances.stiffness))
    for name in SHOWN:
        result = summary.find(name)
        if result is not None:
            console.print(_line(result), highlight=False)
    faults = summary.find("faults")
    if summary.header["mode"] == "realtime" and faults is not None and faults.passed is False:
        console.print(TOO_BUSY)
    wrong = [result for result in summary.results if result.passed is False]
    for result in wrong:
        console.print(f"[bold red]out of tolerance:[/] {_line(result)}", highlight=False)


def _stiffness_table(pushes: list[Measured], tolerance: float) -> Table:
    table = Table(
        title="How soft is the tip?", title_justify="left", box=None, padding=(0, 1, 0, 0)
    )
    columns = ("push", "force", "moved", "felt", "friction", "band", "less friction", "asked", "")
    for name in columns:
        table.add_column(name, justify="left" if name == "push" else "right", header_style="dim")
    for measured in pushes:
        force, unit = ("N m", "N m/rad") if measured.angular else ("N", "N/m")
        moved = measured.moved * (180 / math.pi if measured.angular else 1e3)
        value = measured.stiffness_without_friction
        good = abs(value - measured.asked) <= tolerance * measured.asked
        table.add_row(
            measured.axis,
            f"{measured.force:.1f} {force}",
            f"{moved:.2f} {'°' if measured.angular else 'mm'}",
            f"{measured.stiffness:.1f} {unit}",
            f"{measured.friction_took:.2f} {force}",
            f"±{measured.friction_bound:.2f}",
            f"{value:.1f} {unit}",
            f"{measured.asked:.1f} {unit}",
            "[green]ok[/]" if good else "[bold red]NO[/]",
        )
    return table


def _line(result: Result) -> str:
    value = f"{result.value:.4g}" if isinstance(result.value, float) else result.value
    value = {True: "yes", False: "no"}.get(value, value) if isinstance(value, bool) else value
    asked = f" (predicted {result.asked:.4g})" if isinstance(result.asked, float) else ""
    note = f"  [dim]{result.note}[/]" if result.note else ""
    return f"{result.name}: {value} {result.unit}{asked}{note}"
