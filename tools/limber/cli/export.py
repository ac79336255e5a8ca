"""Commands that write a robot for other programs: `limber export ...`."""

from pathlib import Path
from typing import Annotated

import typer

from limber.cli import groups
from limber.cli.options import console

app = groups.export


@app.command(epilog="Example: limber export mjcf my_arm --out my_arm.xml")
def mjcf(
    robot: Annotated[str, typer.Argument(help="The arm's name or folder.")],
    out: Annotated[Path, typer.Option("--out", help="File to write.")] = Path("robot.xml"),
) -> None:
    """Write a MuJoCo model: bodies, armature, damping, friction loss, limits, motors."""
    from limber.export import mjcf as module
    from limber.model.robot import load_robot

    arm = load_robot(robot)
    module.write(arm, out)
    console.print(f"wrote {out}", soft_wrap=True)
    for what in module.left_out(arm):
        console.print(f"MuJoCo's joints do not have {what}")
