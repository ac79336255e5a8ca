"""`limber check`: robots, URDFs and scenarios, read by the code that all programs share."""

import subprocess
from pathlib import Path

from limber.errors import InputError
from limber.paths import program, robot_folder


def check(what: str, base: str | None, tip: str | None) -> int:
    command = [str(program("limber-check")), *_words(what, base, tip)]
    return subprocess.run(command, check=False).returncode


def _words(what: str, base: str | None, tip: str | None) -> list[str]:
    path = Path(what)
    if path.suffix == ".urdf":
        if not path.is_file():
            raise InputError(f"{path} does not exist: a URDF file is wanted")
        if base is None or tip is None:
            raise InputError(
                f"a bare URDF needs its ends: limber check {path} --base LINK --tip LINK"
            )
        return ["urdf", str(path), "--base", base, "--tip", tip]
    if base is not None or tip is not None:
        raise InputError("--base and --tip are for a bare .urdf; a robot's are in its robot.yaml")
    if path.is_file() and path.suffix in (".yaml", ".yml") and path.name != "robot.yaml":
        return ["scenario", str(path)]
    folder = robot_folder(str(path.parent) if path.name == "robot.yaml" else what)
    return ["robot", str(folder)]


def check_scenario(path: Path) -> None:
    """Raises InputError with the program's complaint if the scenario or its robot is not right."""
    command = [str(program("limber-check")), "scenario", str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        said = [line for line in done.stderr.splitlines() if line.strip()]
        complaint = said[-1].removeprefix("limber-check: ") if said else "it is not right"
        raise InputError(complaint)
