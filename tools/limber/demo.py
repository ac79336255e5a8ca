"""`limber demo`: pushes a simulated arm on a CAN bus and shows how soft it turned out to be."""

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
    "realtime priority granted",
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
        console.print(_stiffness_table(summary, pushes))
    for name in SHOWN:
        result = summary.find(name)
        if result is not None:
            console.print(_line(result), highlight=False)
    wrong = [result for result in summary.results if result.passed is False]
    for result in wrong:
        console.print(f"[bold red]out of tolerance:[/] {_line(result)}", highlight=False)


def _stiffness_table(summary: Summary, pushes: list[Measured]) -> Table:
    table = Table(
        title="How soft is the tip?", title_justify="left", box=None, padding=(0, 2, 0, 0)
    )
    for name in ("push", "force", "moved", "measured", "asked", "friction may hide", ""):
        table.add_column(name, justify="left" if name == "push" else "right", header_style="dim")
    results = [result for result in summary.results if result.name.startswith("stiffness ")]
    for measured, result in zip(pushes, results, strict=False):
        moved = float(measured.displacement @ measured.direction)
        force = "N m" if measured.angular else "N"
        table.add_row(
            measured.axis,
            f"{measured.force:.1f} {force}",
            f"{moved * 57.29578:.2f} °" if measured.angular else f"{moved * 1e3:.2f} mm",
            f"{measured.stiffness:.1f} {result.unit}",
            f"{measured.asked:.1f} {result.unit}",
            f"{measured.friction_force:.2g} {force}",
            "[green]ok[/]" if result.passed else "[bold red]NO[/]",
        )
    return table


def _line(result: Result) -> str:
    value = f"{result.value:.4g}" if isinstance(result.value, float) else result.value
    value = {True: "yes", False: "no"}.get(value, value) if isinstance(value, bool) else value
    asked = f" (predicted {result.asked:.4g})" if isinstance(result.asked, float) else ""
    note = f"  [dim]{result.note}[/]" if result.note else ""
    return f"{result.name}: {value} {result.unit}{asked}{note}"
