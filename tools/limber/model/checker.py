"""limber-check: the one reader of robots, URDFs and scenarios, and what it resolves them to."""

import json
import subprocess
from pathlib import Path
from typing import Any

from limber.errors import InputError, RunError
from limber.paths import captured, existing_file, program, robot_folder, scenario_file


def checker_arguments(what: str, base: str | None, tip: str | None) -> list[str]:
    """Arguments of limber-check for a robot's name or folder, a URDF, or a scenario."""
    path = Path(what)
    if path.suffix in (".urdf", ".xacro"):
        existing_file(path, "URDF file")
        ends = {"--base": base, "--tip": tip}
        given = [word for end, link in ends.items() if link is not None for word in (end, link)]
        return ["urdf", str(path), *given]
    if base is not None or tip is not None:
        raise InputError("--base and --tip are for a bare .urdf; a robot's are in its robot.yaml")
    if path.suffix in (".yaml", ".yml") and path.name != "robot.yaml":
        return ["scenario", str(scenario_file(path))]
    folder = robot_folder(str(path.parent) if path.name == "robot.yaml" else what)
    return ["robot", str(folder)]


def run_checker(arguments: list[str]) -> subprocess.CompletedProcess[str]:
    command = [str(program("limber-check")), *arguments]
    return captured(command)


def resolved(arguments: list[str]) -> dict[str, Any]:
    """What limber-check prints as JSON. Raises InputError with its complaints."""
    done = run_checker(arguments)
    if done.returncode != 0:
        told = done.stderr.strip() or f"limber-check failed (exit code {done.returncode})"
        kind = InputError if done.returncode > 0 else RunError  # killed
        raise kind(told.removeprefix("limber-check: "))
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def kept(file: Path, form: str) -> dict[str, Any] | None:
    """What was resolved when a log was recorded; None if there is no such file. Raises
    InputError.
    """
    try:
        found = json.loads(file.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:
        raise InputError(f"{file} cannot be read: {error}") from error
    word = found.get("format") if isinstance(found, dict) else None
    if word != form:
        raise InputError(
            f"{file}: format: '{word}'; expected {form}; without this file, the YAML beside it is "
            "read again"
        )
    content: dict[str, Any] = found
    return content
