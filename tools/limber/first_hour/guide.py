"""Step by step, from where the last call ended."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from limber import tables
from limber.errors import OK, OUT_OF_TOLERANCE, InputError
from limber.first_hour import motors_step, powered, wire_step, zero_step
from limber.first_hour.person import answer
from limber.first_hour.record import FAILED, PASSED, SKIPPED, Found, Record, failed
from limber.joint_check import command as joint_check
from limber.joint_check.check import Amounts
from limber.joint_check.drives import DriverOptions
from limber.keys import ENTER
from limber.live import network
from limber.model.robot import Robot, load_robot
from limber.paths import output_folder
from limber.run import buses

SKIP = "s"
STYLES = {PASSED: "green", FAILED: "bold red", SKIPPED: "yellow"}


@dataclass(frozen=True)
class Step:
    """`before`: what the person has to know, and agree to, before it begins."""

    name: str
    purpose: str
    check: Callable[[Robot, Path, Console], Found]
    before: str = ""


def _directions(robot: Robot, folder: Path, console: Console) -> Found:
    path = folder / "directions.json"
    code = joint_check.run(str(robot.folder), DriverOptions(), Amounts(), path, console)
    if code == OK:
        return Found(PASSED, (f"every joint, by hand: {path.name}",))
    return failed(f"not every joint is right: {path.name}", "change robot.yaml as printed")


OFF = "The drives stay off: support the arm, it has no torque."
ON = "The drives come on. Arm supported, nobody within its reach, a hand on the emergency stop?"
STEPS = (
    Step("wire", "CAN interfaces and bit rates", lambda robot, _, __: wire_step.check(robot)),
    Step(
        "motors",
        "each motor of robot.yaml, once",
        lambda robot, folder, _: motors_step.check(robot, folder),
    ),
    Step("zero", "angles against the arm", lambda r, _, console: zero_step.check(r, console), OFF),
    Step("directions", "each joint turned by hand", _directions, OFF),
    Step("hold", "HOLD with little torque; weight against the model", powered.hold, ON),
    Step("push", "soft; the first push", powered.push, ON),
)
NAMES = tuple(step.name for step in STEPS)


def run(name: str, out: Path | None, begin: str | None, console: Console) -> int:
    """Exit code: OK once no step is left that has not passed. `begin`: a step to go back to."""
    if begin is not None and begin not in NAMES:
        raise InputError(f"--from {begin}: expected one of {', '.join(NAMES)}")
    robot = load_robot(name)
    if not buses.real(robot.buses):
        network.ensure_multicast(False)
    record = Record(robot, output_folder(out or Path("out") / "first_hour" / robot.name))
    if record.renewed:
        console.print("robot.yaml or the URDF has changed since: every step is done again.")
    first = NAMES.index(begin) if begin else 0
    left_out = next((name for name in NAMES[:first] if name not in record.found), None)
    if left_out is not None:
        raise InputError(f"--from {begin}: {left_out} comes before it and has not been done")
    for number, step in enumerate(STEPS):
        known = record.found.get(step.name)
        wanted = begin or known is None or known.verdict != PASSED
        if number >= first and wanted and not _do(step, robot, record, console):
            break
    _show(record, console)
    done = all(name in record.found and record.found[name].verdict == PASSED for name in NAMES)
    return OK if done else OUT_OF_TOLERANCE


def _do(step: Step, robot: Robot, record: Record, console: Console) -> bool:
    """Whether to go on."""
    console.rule(f"{step.name}: {step.purpose}")
    try:
        if step.before:
            question = f"{step.before} Enter go on, s skip, q quit"
            if answer(console, question, SKIP) != ENTER:
                record.note(step.name, Found(SKIPPED))
                return True
        found = step.check(robot, record.folder.resolve(), console)
    except KeyboardInterrupt:
        console.print("stopped by you")
        return False
    record.note(step.name, found)
    for line in found.lines:
        console.print(line, markup=False, highlight=False, soft_wrap=True)
    console.print(found.verdict, style=STYLES[found.verdict])
    if found.cure:
        console.print(f"To do: {found.cure}", markup=False, highlight=False, soft_wrap=True)
    return found.verdict == PASSED


def _show(record: Record, console: Console) -> None:
    console.rule("first hour")
    table = tables.table("<step", "<", "<", "<when")
    for step in STEPS:
        found = record.found.get(step.name, Found("to do"))
        table.add_row(step.name, step.purpose, found.verdict, found.when)
    console.print(table)
    console.print(f"The protocol, to attach to a question: {record.text_path}", soft_wrap=True)
