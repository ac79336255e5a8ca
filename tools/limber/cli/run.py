"""Commands that run scenarios and judge the result."""

import json
from pathlib import Path
from typing import Annotated

import typer

from limber.cli import groups
from limber.cli.options import (
    Bus,
    Out,
    Private,
    Robot,
    ScenarioPath,
    become,
    bus_words,
    console,
)
from limber.errors import InputError

app = typer.Typer()
Page = Annotated[
    bool, typer.Option("--page", help="Serve the web page beside it: 3D, charts, STOP.")
]

Lockstep = Annotated[
    bool | None,
    typer.Option(
        "--lockstep/--realtime",
        help="As fast as possible, or each process by this machine's clock. Default: a simulated "
        "arm at the clock's pace, unless its scenario has another mode.",
    ),
]

OneProcess = Annotated[
    bool,
    typer.Option(
        "--one-process",
        help="Driver, controller and simulator in one: keeps up on a busy machine.",
    ),
]

OtherRobot = Annotated[
    str | None, typer.Option("--robot", help="Another arm than the scenario's: name or folder.")
]

Plain = Annotated[
    bool,
    typer.Option("--record-plain", help="Leave run.lcmlog, not the compressed run.lcmlog.zst."),
]


@app.command(epilog="Example: limber demo --page")
def demo(
    what: Annotated[
        str, typer.Argument(help="pushes; or policy: one picks and places, and is killed.")
    ] = "pushes",
    out: Out = None,
    seconds: Annotated[
        float | None, typer.Option(min=1.0, max=600.0, help="Stop after this much arm time.")
    ] = None,
    lockstep: Lockstep = None,
    one_process: OneProcess = False,
    no_watch: Annotated[
        bool, typer.Option("--no-watch", help="Show the progress only, not the live view.")
    ] = False,
    sensors: Annotated[
        bool,
        typer.Option("--sensors", help="An arm with joint torque sensors: it hides its friction."),
    ] = False,
    page: Page = False,
    private: Private = False,
) -> None:
    """Push a simulated arm on a CAN bus and measure its stiffness: the main job in a minute."""
    from limber.run import demo as module
    from limber.run.options import RunOptions

    options = RunOptions(
        out,
        lockstep,
        one_process,
        live_view=not no_watch,
        private_network=private,
        page=page,
        leave_when_behind=not one_process,
    )
    if what not in ("pushes", "policy"):
        raise InputError(f"{what}: there are the demos pushes and policy")
    if what == "policy":
        from limber.run import policy_demo

        raise typer.Exit(policy_demo.demo(options, console))
    raise typer.Exit(module.demo(seconds, sensors, options, console))


@app.command(epilog="Example: limber run scenarios/push.yaml --out out/push")
def run(
    scenario: ScenarioPath,
    robot: OtherRobot = None,
    out: Out = None,
    lockstep: Lockstep = None,
    one_process: OneProcess = False,
    bus: Bus = None,
    rate: Annotated[
        float | None,
        typer.Option(min=10.0, max=20000.0, help="Cycles per second instead of robot.yaml's."),
    ] = None,
    no_sim: Annotated[
        bool, typer.Option("--no-sim", help="A real arm (or another simulator) is on the bus.")
    ] = False,
    can: Annotated[
        bool, typer.Option("--can", help="Record the CAN frames, too: run.can.log.")
    ] = False,
    page: Page = False,
    record: Annotated[
        bool | None,
        typer.Option("--record/--no-record", help="Overrides the scenario's `record`."),
    ] = None,
    record_plain: Plain = False,
    private: Private = False,
) -> None:
    """Run a scenario with the real processes, record it, measure it."""
    from limber.run import commands
    from limber.run.options import RunOptions

    options = RunOptions(
        out,
        lockstep,
        one_process,
        tuple(bus or ()),
        not no_sim,
        private,
        rate_hz=rate,
        record=record,
        record_plain=record_plain,
        record_can=can,
        page=page,
        robot=robot,
    )
    raise typer.Exit(commands.run(scenario, options, console))


@app.command(epilog="Example: limber lab scenarios/push.yaml --out out/push")
def lab(
    scenario: ScenarioPath,
    robot: OtherRobot = None,
    out: Out = None,
    can: Annotated[
        bool, typer.Option("--can", help="Write the CAN frames, too: run.can.log.")
    ] = False,
    record_plain: Plain = False,
) -> None:
    """Run a scenario in one process, as fast as possible; the same bytes as run --lockstep."""
    from limber.run import commands
    from limber.run.options import RunOptions

    options = RunOptions(out, record_can=can, record_plain=record_plain, robot=robot)
    raise typer.Exit(commands.lab(scenario, options, console))


@app.command(epilog="Example: limber sim openarm")
def sim(
    robot: Robot,
    bus: Bus = None,
    scenario: Annotated[
        Path | None, typer.Option(help="Start pose, friction, what happens when.")
    ] = None,
    rate: Annotated[
        float | None,
        typer.Option(min=10.0, max=20000.0, help="Control periods per second."),
    ] = None,
    no_stand: Annotated[
        bool, typer.Option("--no-stand", help="Nothing carries the arm before its drives do.")
    ] = False,
    no_friction: Annotated[
        bool, typer.Option("--no-friction", help="Joints without friction.")
    ] = False,
    paced: Annotated[
        bool,
        typer.Option(
            "--paced", help="In lock step with limber-driver --paced and limber-controller --paced."
        ),
    ] = False,
) -> None:
    """Simulate an arm behind its motor drives in real time, until Ctrl-C."""
    from limber.run.simulate import introduce

    words = [*bus_words(bus), "--paced" if paced else "--realtime"]
    if scenario is not None:
        words += ["--scenario", str(scenario)]
    if rate is not None:
        words += ["--rate", f"{rate:.9g}"]
    words += ["--no-stand"] * no_stand + ["--no-friction"] * no_friction
    folder = introduce(robot, bus_words(bus), no_stand, paced, console)
    become("limber-sim", "--robot", str(folder), *words)


@groups.log.command(epilog="Example: limber log measure out/push")
def measure(
    folder: Annotated[Path, typer.Argument(help="Folder of a run.")],
    run: Annotated[
        int | None,
        typer.Option("--run", min=1, help="Which, if its log holds several; default: the last."),
    ] = None,
) -> None:
    """Measure a recorded run again, from its log and scenario."""
    from limber.run import commands

    raise typer.Exit(commands.measure_again(folder, run, console))


@app.command(epilog="Example: limber check scenarios/push.yaml")
def check(
    what: Annotated[str, typer.Argument(help="A robot's name or folder, a URDF, or a scenario.")],
    base: Annotated[str | None, typer.Option(help="Base link, for a bare URDF.")] = None,
    tip: Annotated[str | None, typer.Option(help="Tip link, for a bare URDF.")] = None,
    picture: Annotated[
        Path | None, typer.Option(help="Draw the traffic of a cycle on the robot's buses (PNG).")
    ] = None,
) -> None:
    """Check a robot, URDF or scenario with the code that all programs share."""
    from limber.model.checker import checker_arguments

    arguments = checker_arguments(what, base, tip)
    if picture is not None:
        _bus_picture(arguments, picture)
    become("limber-check", *arguments)


@app.command(epilog="Example: limber new my_arm.urdf --base base_link --tip tool0 --drives damiao")
def new(
    urdf: Annotated[Path, typer.Argument(help="URDF file.")],
    drives: Annotated[
        str | None,
        typer.Option(help="Protocol of the drives, or its beginning: damiao, moteus, ..."),
    ] = None,
    scan: Annotated[
        list[str] | None,
        typer.Option("--scan", help="Bus to find the motors on, can0; any number of times."),
    ] = None,
    fd: Annotated[bool, typer.Option("--fd", help="The buses of --scan are CAN-FD.")] = False,
    base: Annotated[str | None, typer.Option(help="Link the arm is fixed by.")] = None,
    tip: Annotated[str | None, typer.Option(help="Link the arm works with.")] = None,
    name: Annotated[str | None, typer.Option(help="Of the arm; default: of the file.")] = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder to make.")] = None,
) -> None:
    """Write a first robot folder and scenario for your own arm, from its URDF."""
    from limber.new import write as module

    raise typer.Exit(module.write(urdf, (base, tip), drives, (scan or [], fd), name, out, console))


@groups.export.command(epilog="Example: limber export service my_arm")
def service(
    robot: Robot,
    out: Annotated[Path, typer.Option("--out", help="Folder for the files.")] = Path("out/service"),
    bus: Bus = None,
) -> None:
    """Write systemd units that run driver and controller of a real arm."""
    from limber.run import service as module

    raise typer.Exit(module.write(robot, tuple(bus or ()), out, console))


def _bus_picture(arguments: list[str], path: Path) -> None:
    from limber.model.checker import run_checker

    if arguments[0] != "robot":
        raise InputError("--picture is for a robot: only it has buses")
    done = run_checker([*arguments, "--json"])
    if done.returncode == 0:  # else the check below reports why
        from limber.plot import bus_cycle

        bus_cycle.draw(json.loads(done.stdout), path)
        console.print(f"{path}  [dim]one cycle on each bus[/]", highlight=False, soft_wrap=True)
