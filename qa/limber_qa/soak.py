"""`limber dev soak`: hours of arm time in lock step, as limber-soak makes them."""

import json
import subprocess
from pathlib import Path
from typing import Any

from rich.console import Console

from limber import tables
from limber.errors import OK, OUT_OF_TOLERANCE, RunError
from limber.paths import output_folder, program


def run(
    robot: str,
    hours: float,
    seconds: float,
    seed: int,
    any_request: bool,
    out: Path,
    console: Console,
) -> int:
    """limber-soak, its progress, and its report as soak.json."""
    command = [str(program("limber-soak")), "--robot", robot, "--arm-hours", str(hours)]
    command += ["--most-seconds", str(seconds), "--seed", str(seed), "--progress"]
    command += ["--any-request"] if any_request else []
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    if not done.stdout:
        raise RunError(f"limber-soak ended with exit code {done.returncode}: see above")
    folder = output_folder(out)
    (folder / "soak.json").write_text(done.stdout, encoding="utf-8")
    report = json.loads(done.stdout)
    console.print(_table(report))
    for violation in report["violations"]:
        console.print(f"[bold red]{violation}[/]")
    console.print(f"report: {folder / 'soak.json'}", soft_wrap=True)
    return OK if done.returncode == 0 else OUT_OF_TOLERANCE


def _table(report: dict[str, Any]) -> Any:
    table = tables.table("<", ">", title=f"soak of {report['robot']}, seed {report['seed']}")
    table.add_row("arm time", f"{report['arm_time_h']:.3f} h")
    table.add_row("wall time", f"{report['wall_s']:.0f} s")
    for name, count in report["actions"].items():
        table.add_row(name, str(count))
    for fault, causes in report["reactions"].items():
        text = ", ".join(f"{cause} {count}" for cause, count in causes.items())
        table.add_row(f"{fault} led to", text)
    table.add_row("recoveries", str(report["recoveries"]))
    table.add_row("longest recovery", f"{report['longest_recovery_s']:.2f} s")
    table.add_row("put back by hand", str(report["put_back"]))
    begin, end = (report["process"][when] for when in ("after_a_minute", "at_the_end"))
    table.add_row("memory", f"{begin['resident_kB']} to {end['resident_kB']} kB")
    table.add_row("descriptors", f"{begin['descriptors']} to {end['descriptors']}")
    return table
