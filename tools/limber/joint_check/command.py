"""The command: drives off, joint by joint, a table at the end."""

from pathlib import Path

from rich.console import Console

from limber.errors import OK, OUT_OF_TOLERANCE, InputError
from limber.joint_check import results, wiring
from limber.joint_check.check import Amounts, Check
from limber.joint_check.drives import DriverOptions, drives
from limber.joint_check.screen import Screen
from limber.keys import Keys
from limber.model.robot import load_robot

HINT = (
    "This arm is simulated and nothing carries it. Push it from another terminal, such as: "
    "limber send --robot {robot} 'push: {{link: {link}, torque_Nm: [0, 0, 2], for_s: 1}}'"
)


def run(
    name: str, options: DriverOptions, amounts: Amounts, json: Path | None, console: Console
) -> int:
    """Returns the exit code: 0 only if every joint was found right."""
    robot = load_robot(name)
    keys = wiring.read_keys(robot.folder / "robot.yaml", robot.joint_names)
    if json is not None and not json.resolve().parent.is_dir():
        raise InputError(f"--json {json}: the folder {json.parent} does not exist")
    with drives(robot, options, console) as found:
        check = Check(robot, keys, amounts, found)
        if found.simulated and not options.private_network:
            hint = HINT.format(robot=name, link=robot.tip)
            console.print(hint, markup=False, highlight=False, soft_wrap=True)
        try:
            with Keys() as person, Screen(console) as screen:
                check.run(screen, person)
        except KeyboardInterrupt:
            console.print("stopped by you")
        finally:
            results.print_table(check.rows, console)
            if json is not None:
                results.write_json(check.rows, robot.folder, json)
    console.print(results.conclusion(check.rows), soft_wrap=True)
    return OK if results.passed(check.rows) else OUT_OF_TOLERANCE
