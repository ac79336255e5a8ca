"""Robots, URDFs and scenarios, checked by limber-check: the code that all programs share."""

import json
import subprocess
from pathlib import Path

from limber.errors import InputError
from limber.model.robot import Robot, load_robot
from limber.model.scenario import Scenario, load_scenario
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


def load_checked_robot(name_or_folder: str) -> Robot:
    """Raises InputError with limber-check's complaints if the robot is wrong."""
    done = run_checker(["robot", str(robot_folder(name_or_folder))])
    if done.returncode != 0:
        raise InputError(done.stderr.strip())
    return load_robot(name_or_folder)


def load_checked(path: Path) -> Scenario:
    """Raises InputError with limber-check's message if the scenario or its robot is wrong."""
    path = scenario_file(path)
    done = run_checker(["scenario", str(path), "--json"])
    if done.returncode != 0:
        lines = [line for line in done.stderr.splitlines() if line.strip()]
        message = lines[-1] if lines else f"limber-check failed (exit code {done.returncode})"
        raise InputError(message.removeprefix("limber-check: "))
    scenario = load_scenario(path)
    found = json.loads(done.stdout)
    scenario.warnings = [*found["warnings"], *found["refused"]]
    scenario.notes = found["notes"]
    return scenario
