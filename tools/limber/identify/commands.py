"""The commands of `limber identify`: read logs, identify, print a table, write files."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from rich.console import Console
from rich.table import Table

from limber.errors import InputError
from limber.identify import (
    excitation,
    friction,
    gravity,
    plausible,
    proposal,
    stiffness,
    torque_constant,
    whole_arm,
)
from limber.identify.arm import Arm, load_arm
from limber.identify.csv_recording import read_csv
from limber.identify.findings import Findings
from limber.identify.motion import Motion, motion_of
from limber.identify.recording import Recording, read_logs
from limber.log.reader import Log, log_file
from limber.model.robot import load_robot, robot_beside
from limber.model.scenario import load_scenario
from limber.paths import output_folder

KINDS: dict[str, Callable[[Arm, Motion, float | None], Findings]] = {
    "torque-constant": torque_constant.identify,
    "friction": friction.identify,
    "stiffness": lambda arm, motion, _: stiffness.identify(arm, motion),
    "gravity": lambda arm, motion, _: gravity.identify(arm, motion),
}


@dataclass(frozen=True)
class Source:
    """What to identify from: logs of runs, or a CSV file with the table of its columns."""

    runs: list[Path]
    robot: str | None = None
    csv: Path | None = None
    columns: Path | None = None
    run: int | None = None  # of logs that hold several; None: all

    def read(self, console: Console) -> tuple[Arm, list[Recording], Path]:
        """The arm, its recordings, and the folder that results go to unless another is named.
        Prints what is doubtful of them.
        """
        arm, recordings, beside = self._read(console)
        for doubt in plausible.check(recordings, arm):
            console.print(f"[yellow]{doubt}[/]", soft_wrap=True)
        return arm, recordings, beside

    def _read(self, console: Console) -> tuple[Arm, list[Recording], Path]:
        if self.csv is None:
            if not self.runs:
                raise InputError("missing 'runs': logs or folders of runs; or a --csv recording")
            arm = arm_of(self.runs, self.robot)
            if self.run is None:
                for line in several_runs(self.runs):
                    console.print(line, soft_wrap=True)
            return arm, read_logs(self.runs, arm, self.run), folder_of(self.runs)
        if self.runs or self.columns is None or self.robot is None:
            raise InputError("--csv FILE goes with --columns FILE and --robot, and without runs")
        arm = load_arm(self.robot)
        return arm, read_csv(self.csv, self.columns, arm), self.csv.parent / "identify"


def run(
    kind: str, source: Source, weights_known: float | None, out: Path | None, console: Console
) -> None:
    """One of KINDS, or all of them: `arm`."""
    if kind == "arm":
        return _run_all(source, weights_known, out, console)
    arm, recordings, beside = source.read(console)
    found = KINDS[kind](arm, motion_of(recordings), weights_known)
    _print(found, console)
    folder = output_folder(out or beside)
    files = proposal.write(found, arm, kind, folder)
    _write(found, kind, folder, files, console)


def _run_all(
    source: Source, weights_known: float | None, out: Path | None, console: Console
) -> None:
    """Of a scenario, first its tour in the lab. Writes a whole robot folder."""
    scenario = next((path for path in source.runs if path.suffix in (".yaml", ".yml")), None)
    if scenario is not None:
        source, out = _recorded(source, scenario, out)
    arm, recordings, beside = source.read(console)
    folder = output_folder(out or beside)
    if (folder / "robot").exists():
        raise InputError(f"{folder / 'robot'} exists: give another --out, or remove it")
    with console.status("identifying"):
        proposed = whole_arm.propose(arm, motion_of(recordings), weights_known, folder / "robot")
    for found in proposed.found:
        console.print(f"\n[bold]{found.subject}[/bold]")
        if found.values:
            _print(found, console)
        else:
            for joint, reason in found.refused.items():
                console.print(f"{joint}: not identified: {reason}")
        name = found.subject.replace(" ", "_")
        _write(found, name, folder, [], console)
    if source.csv is None:
        again = _again(scenario, arm, proposed, folder, console)
        console.print(whole_arm.sags(arm, proposed, source.runs, again))
    console.print(f"wrote {proposed.folder}: the robot as it is proposed", soft_wrap=True)


def _recorded(source: Source, scenario: Path, out: Path | None) -> tuple[Source, Path]:
    if len(source.runs) > 1 or source.csv is not None:
        raise InputError("a scenario is run by itself: name no other runs and no CSV file")
    folder = output_folder(out or Path("out") / f"identify_{scenario.stem}")
    loaded = load_scenario(scenario)
    log = whole_arm.record(scenario, folder / "before.lcmlog")
    return replace(source, runs=[log], robot=str(loaded.robot.folder)), folder


def _again(
    scenario: Path | None, arm: Arm, proposed: whole_arm.Proposal, folder: Path, console: Console
) -> Path | None:
    if scenario is None:
        return None
    with console.status("running the tour with the proposal"):
        path = whole_arm.scenario_with(scenario, arm, proposed, folder / "again.yaml")
        return whole_arm.record(path, folder / "after.lcmlog")


def plan(robot: str, spread: float, count: int, seed: int, out: Path, console: Console) -> None:
    arm = Arm(load_robot(robot))
    console.print(excitation.write(arm, robot, spread, count, seed, out))
    console.print(
        "The motion avoids no obstacles: give the arm room. Record it with limber lab, limber run, "
        "or on the real arm limber run --no-sim. One log serves all commands of limber identify.",
    )


def several_runs(logs: list[Path]) -> list[str]:
    counts = [(path, Log(path).runs) for path in logs]
    return [
        f"{path}: {count} runs, all of which are used; --run N chooses one"
        for path, count in counts
        if count > 1
    ]


def arm_of(runs: list[Path], robot: str | None) -> Arm:
    """The robot that is named, else the copy that lies beside the first log."""
    if robot is not None:
        return load_arm(robot)
    beside = robot_beside(log_file(runs[0]).parent)
    if beside is None:
        raise InputError(f"no robot.yaml lies beside {runs[0]}: name the arm with --robot")
    return Arm(beside)


def folder_of(runs: list[Path]) -> Path:
    return log_file(runs[0]).parent / "identify"


def _print(found: Findings, console: Console) -> None:
    found.require_something()
    table = Table("joint", "quantity", "value", "std. error", "believed", "unit")
    for column in table.columns[2:5]:
        column.justify = "right"
    for value in found.values:
        before = "-" if value.believed is None else f"{value.believed:.4g}"
        cells = (f"{value.value:.4g}", f"{value.std:.2g}", before, value.unit)
        table.add_row(value.joint, value.name, *cells)
    console.print(table)
    for joint, reason in found.refused.items():
        console.print(f"{joint}: not identified: {reason}")
    for note in found.notes:
        console.print(note)


def _write(found: Findings, name: str, folder: Path, files: list[Path], console: Console) -> None:
    from limber.identify import picture  # matplotlib takes a second to load

    if found.panels:
        files.append(picture.save(found.panels, found.subject, folder / f"{name}.png"))
    for path in files:
        console.print(f"wrote {path}", soft_wrap=True)
