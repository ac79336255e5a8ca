"""`limber new`: writes the folder and the scenario, and what to do next."""

import re
import shutil
import tempfile
from pathlib import Path

from rich.console import Console

from limber.errors import OK, InputError
from limber.model.checker import run_checker
from limber.model.protocols import Protocol, protocol, protocols
from limber.new import facts, robot_text, scenario_text
from limber.new.guesses import Guesses, guess
from limber.output import write_new
from limber.paths import existing_file

RATES_Hz = (1000, 500, 250, 100)


def write(
    urdf: Path,
    ends: tuple[str | None, str | None],
    drives: str,
    name: str | None,
    out: Path | None,
    console: Console,
) -> int:
    """`ends`: base and tip; `out`: the folder to make, default ./NAME. Raises InputError."""
    existing_file(urdf, "URDF file")
    chosen = protocol(drives)
    name = name or re.sub(r"[^A-Za-z0-9_-]+", "_", urdf.name.split(".")[0])
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_-]{0,39}", name):
        raise InputError(f"--name '{name}': a letter, then letters, digits, _ or -, at most 40")
    folder = out or Path(name)
    scenario = folder.parent / f"{name}_first.yaml"
    for path in (folder, scenario):
        if path.exists():
            raise InputError(f"{path} exists already and is left as it is; give --name or --out")
    arm = facts.read(urdf, *ends)
    sliding = [joint.name for joint in arm.joints if joint.slides]
    if sliding and chosen.rotary_only:
        others = " or ".join(entry.word for entry in protocols() if not entry.rotary_only)
        raise InputError(
            f"{chosen.title} drives count turns; {', '.join(sliding)} slides: use {others}"
        )
    guesses = guess(arm, chosen)
    rate = _write_robot(folder, name, arm, guesses, chosen)
    write_new(scenario, scenario_text.text(name, folder.name, scenario.name, arm, guesses))
    _tell(folder, scenario, rate, console)
    return OK


def _write_robot(
    folder: Path, name: str, arm: facts.ArmFacts, guesses: Guesses, drives: Protocol
) -> int:
    """At the highest rate that the buses carry, which is returned."""
    complaint = ""
    with tempfile.TemporaryDirectory() as scratch:
        draft = Path(scratch) / name
        draft.mkdir()
        shutil.copyfile(arm.urdf, draft / "robot.urdf")
        for rate in RATES_Hz:
            text = robot_text.text(name, arm, guesses, drives, rate)
            (draft / "robot.yaml").write_text(text, encoding="utf-8")
            done = run_checker(["robot", str(draft)])
            if done.returncode == 0:
                _move(draft, folder)
                return rate
            complaint = done.stderr.strip()
    raise InputError(f"{arm.urdf} makes no robot that limber can run:\n{complaint}")


def _move(draft: Path, folder: Path) -> None:
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        shutil.copytree(draft, folder)
    except OSError as error:
        raise InputError(f"{folder} cannot be written ({error.strerror}): give --out") from error


def _tell(folder: Path, scenario: Path, rate: int, console: Console) -> None:
    guessed = (folder / "robot.yaml").read_text(encoding="utf-8").count("guess:")
    lines = [
        f"{folder} and {scenario}: {rate} Hz, {guessed} guesses",
        f"  1. limber check {folder}         what limber makes of it",
        f"  2. limber lab {scenario}   the arm, simulated: held, soft, pushed",
        f"  3. replace every 'guess:' in {folder / 'robot.yaml'} (docs/own_arm.md), then read "
        "docs/safety.md",
    ]
    for line in lines:
        console.print(line, markup=False, highlight=False, soft_wrap=True)
