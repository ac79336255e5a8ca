"""`limber new`: writes the folder and the scenario, and what to do next."""

import re
import shutil
import tempfile
from pathlib import Path

from rich.console import Console

from limber.errors import OK, InputError
from limber.model.checker import run_checker
from limber.model.protocols import protocol, protocols
from limber.new import facts, robot_text, scenario_text, wiring
from limber.new.guesses import Guesses, guess
from limber.new.wiring import Motor
from limber.output import write_new
from limber.paths import existing_file

RATES_Hz = (1000, 500, 250, 100)


def write(
    urdf: Path,
    ends: tuple[str | None, str | None],
    drives: str | None,
    scan: tuple[list[str], bool],
    name: str | None,
    out: Path | None,
    console: Console,
) -> int:
    """`ends`: base and tip; `scan`: buses to look for motors on, and whether they are CAN-FD;
    `out`: the folder to make, default ./NAME. Raises InputError.
    """
    existing_file(urdf, "URDF file")
    if drives is None and not scan[0]:
        raise InputError("--drives: the protocol of the drives, or --scan BUS, which finds them")
    chosen = protocol(drives) if drives else None
    name = name or re.sub(r"[^A-Za-z0-9_-]+", "_", urdf.name.split(".")[0])
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_-]{0,39}", name):
        raise InputError(f"--name '{name}': a letter, then letters, digits, _ or -, at most 40")
    folder = out or Path(name)
    scenario = folder.parent / f"{name}_first.yaml"
    for path in (folder, scenario):
        if path.exists():
            raise InputError(f"{path} exists already and is left as it is; give --name or --out")
    arm = facts.read(urdf, *ends)
    found = wiring.found(*scan, drives) if scan[0] else []
    matched = len(found) == len(arm.joints)
    wired = found if matched else wiring.guessed(chosen or wiring.family_of(found), len(arm.joints))
    for joint, motor in zip(arm.joints, wired, strict=True):
        if joint.slides and motor.drives.rotary_only:
            others = " or ".join(entry.word for entry in protocols() if not entry.rotary_only)
            raise InputError(
                f"{motor.drives.title} drives count turns; {joint.name} slides: use {others}"
            )
    guesses = guess(arm, wired)
    rate = _write_robot(folder, name, arm, guesses, wired, [] if matched else found)
    write_new(scenario, scenario_text.text(name, folder.name, scenario.name, arm, guesses))
    _tell(folder, scenario, rate, _found_lines(found, arm), console)
    return OK


def _write_robot(
    folder: Path,
    name: str,
    arm: facts.ArmFacts,
    guesses: Guesses,
    wired: list[Motor],
    left: list[Motor],
) -> int:
    """At the highest rate that the buses carry, which is returned."""
    complaint = ""
    with tempfile.TemporaryDirectory() as scratch:
        draft = Path(scratch) / name
        draft.mkdir()
        shutil.copyfile(arm.urdf, draft / "robot.urdf")
        for rate in RATES_Hz:
            text = robot_text.text(name, arm, guesses, wired, left, rate)
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


def _found_lines(found: list[Motor], arm: facts.ArmFacts) -> list[str]:
    if not found:
        return []
    if len(found) != len(arm.joints):
        return [
            f"found {len(found)} motors for {len(arm.joints)} joints: listed in robot.yaml for you "
            "to assign; wiring and ranges there are guessed"
        ]
    lines = [
        f"  {joint.name}: {motor.word} on {motor.found_on}, {len(motor.keys)} values read"
        for joint, motor in zip(arm.joints, found, strict=True)
    ]
    return [
        "joints and motors in order of number, a guess: limber identify joints tries it",
        *lines,
    ]


def _tell(folder: Path, scenario: Path, rate: int, found: list[str], console: Console) -> None:
    guessed = (folder / "robot.yaml").read_text(encoding="utf-8").count("guess:")
    lines = [
        *found,
        f"{folder} and {scenario}: {rate} Hz, {guessed} guesses",
        f"  1. limber check {folder}         what limber makes of it",
        f"  2. limber lab {scenario}   the arm, simulated: held, soft, pushed",
        f"  3. replace every 'guess:' in {folder / 'robot.yaml'} (docs/own_arm.md), then read "
        "docs/safety.md",
    ]
    for line in lines:
        console.print(line, markup=False, highlight=False, soft_wrap=True)
