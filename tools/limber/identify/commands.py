"""The commands of `limber identify`: read logs, identify, print a table, write files."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.table import Table

from limber.errors import InputError
from limber.identify import excitation, friction, gravity, proposal, stiffness, torque_constant
from limber.identify.arm import Arm, load_arm
from limber.identify.csv_recording import read_csv
from limber.identify.findings import Findings
from limber.identify.motion import Motion, motion_of
from limber.identify.recording import Recording, read_logs
from limber.log.reader import log_file
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

    def read(self) -> tuple[Arm, list[Recording], Path]:
        """The arm, its recordings, and the folder that results go to unless another is named."""
        if self.csv is None:
            if not self.runs:
                raise InputError("name the log or folder of a run, or a recording with --csv")
            arm = arm_of(self.runs, self.robot)
            return arm, read_logs(self.runs, arm), folder_of(self.runs)
        if self.runs or self.columns is None or self.robot is None:
            raise InputError("--csv FILE goes with --columns FILE and --robot, and without runs")
        arm = load_arm(self.robot)
        return arm, read_csv(self.csv, self.columns, arm), self.csv.parent / "identify"


def run(
    kind: str, source: Source, weights_known: float | None, out: Path | None, console: Console
) -> None:
    arm, recordings, beside = source.read()
    found = KINDS[kind](arm, motion_of(recordings), weights_known)
    _print(found, console)
    folder = output_folder(out or beside)
    files = proposal.write(found, arm, kind, folder)
    _write(found, kind, folder, files, console)


def plan(robot: str, spread: float, count: int, seed: int, out: Path, console: Console) -> None:
    arm = load_arm(robot)
    console.print(excitation.write(arm, robot, spread, count, seed, out))
    console.print(
        "The motion avoids no obstacles: give the arm room. Record it with limber lab, limber run, "
        "or on the real arm limber run --no-sim. One log serves all commands of limber identify.",
    )


def arm_of(runs: list[Path], robot: str | None) -> Arm:
    """The robot that is named, else the copy that lies beside the first log."""
    if robot is not None:
        return load_arm(robot)
    folder = log_file(runs[0]).parent
    if not (folder / "robot.yaml").is_file():
        raise InputError(f"no robot.yaml lies beside {runs[0]}: name the arm with --robot")
    return load_arm(str(folder.resolve()))


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
