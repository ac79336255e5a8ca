"""Are the motors of robot.yaml on its buses, each number once?"""

import re
import subprocess
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import yaml

from limber.errors import RunError
from limber.first_hour.record import PASSED, Found, failed
from limber.model.robot import Robot
from limber.paths import output_folder, program
from limber.run import buses
from limber.run.commands import next_folder
from limber.run.processes import process_group

SCAN_S = 60.0
START_S = 10.0
SIMULATED_HZ = 50.0
MOTOR = re.compile(r"^(\w+:\d+)(?:  (.*))?$")


def check(robot: Robot, folder: Path) -> Found:
    with _answering(robot, folder):
        found = {bus["name"]: _scan(bus) for bus in robot.resolved["buses"]}
    return judge(robot.resolved["buses"], expected(robot), found)


def judge(
    all_buses: list[dict[str, Any]],
    wanted: dict[str, dict[str, str]],
    found: dict[str, list[tuple[str, str]]],
) -> Found:
    """`found`: (FAMILY:NUMBER, details) by bus, as often as it answered."""
    lines, cures = [], []
    for bus in all_buses:
        counts = Counter(motor for motor, _ in found[bus["name"]])
        details, joints = dict(found[bus["name"]]), wanted[bus["name"]]
        foreign = sorted(counts.keys() - joints.keys())
        for motor, joint in joints.items():
            there = f"{joint}: {motor} on {bus['name']}"
            lines.append(
                f"{there}: {details.get(motor) or 'answers'}" if motor in counts else there
            )
            if not counts[motor]:
                lines[-1] += ": no answer"
                others = ", ".join(foreign) or "none"
                cures.append(
                    f"{joint}: supply, plug and bit rate of {motor}; motors that answer and are "
                    f"not in robot.yaml: {others} (`limber motors set-id` gives a new number)"
                )
            elif counts[motor] > 1:
                lines[-1] += f": {counts[motor]} answers"
                cures.append(
                    f"{counts[motor]} motors have the number {motor}: unplug one and give it "
                    f"another: limber motors set-id {_bus_word(bus)} {motor} NUMBER"
                )
        lines += [f"{motor} on {bus['name']} is not in robot.yaml" for motor in foreign]
    return failed(lines[0], "; ".join(cures), *lines[1:]) if cures else Found(PASSED, tuple(lines))


def expected(robot: Robot) -> dict[str, dict[str, str]]:
    """By bus: FAMILY:NUMBER -> joint. The number is robot.yaml's, not a frame's identifier."""
    content = yaml.safe_load((robot.folder / "robot.yaml").read_text(encoding="utf-8"))
    given = dict(content["joints"])
    if "hand" in content:
        given["hand"] = content["hand"]
    found: dict[str, dict[str, str]] = {bus: {} for bus in robot.buses}
    for name, joint in given.items():
        family = content["motors"][joint["motor"]]["protocol"]
        for motor in (joint, joint.get("antagonist", {})):
            if "id" in motor:
                bus = motor.get("bus", joint["bus"])
                found[bus][f"{family}:{int(str(motor['id']), 0)}"] = name
    return found


def _bus_word(bus: dict[str, Any]) -> str:
    return str(bus["can"]).removeprefix("socketcan:") + (" --fd" if bus["fd"] else "")


def _scan(bus: dict[str, Any]) -> list[tuple[str, str]]:
    command = [str(program("limber-motors")), "scan", bus["can"], *["--fd"] * bool(bus["fd"])]
    done = subprocess.run(command, capture_output=True, text=True, timeout=SCAN_S, check=False)
    found = [match.groups("") for line in done.stdout.splitlines() if (match := MOTOR.match(line))]
    if done.returncode != 0 and "no motor answers" not in done.stderr:
        raise RunError(f"{bus['can']}: {done.stderr.strip().splitlines()[-1]}")
    return [(motor, details) for motor, details in found]


@contextmanager
def _answering(robot: Robot, folder: Path) -> Iterator[None]:
    """Simulated motors stand on virtual buses meanwhile."""
    if buses.real(robot.buses):
        yield
        return
    rate = f"{min(robot.rate_hz, SIMULATED_HZ):.9g}"
    words = ["--robot", str(robot.folder), "--rate", rate, "--realtime"]
    with process_group(output_folder(next_folder("motors", folder))) as group:
        child = group.start("limber-sim", [str(program("limber-sim")), *words])
        group.wait_for_line(child, "\n", START_S)
        yield
