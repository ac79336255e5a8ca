"""Commands that give an arm to other programs: `limber export ...`."""

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


@app.command(epilog="Example: limber ros2 --allow-commands")
def ros2(
    robot: Annotated[
        str | None, typer.Option(help="Name or folder; default: the arm of the running stack.")
    ] = None,
    rate: Annotated[
        float, typer.Option(min=0.1, max=500.0, help="Messages a second on a topic, at most.")
    ] = 100.0,
    interface: Annotated[
        str,
        typer.Option(
            help="Network interface; all who reach it may listen, and command if allowed."
        ),
    ] = "lo",
    allow_commands: Annotated[
        bool,
        typer.Option("--allow-commands", help="Take /limber/goal_pose and /limber/stiffness."),
    ] = False,
) -> None:
    """Publish the running arm to ROS 2: joints, tip, contact, diagnostics, URDF."""
    from limber.live.network import require_multicast
    from limber.ros2 import bridge

    require_multicast()
    bridge.run(robot, rate, interface, allow_commands, console)
