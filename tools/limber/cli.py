"""The `limber` program: arguments in, one function called, errors out in one line."""

import os
import sys
from pathlib import Path
from typing import Annotated, NoReturn

import typer
from rich.console import Console
from typer.exceptions import TyperException

from limber import __version__
from limber.errors import OUT_OF_TOLERANCE, RUN_FAILED, WRONG_INPUT, LimberError
from limber.experiments.cli import app as experiment_app
from limber.identify.cli import app as identify_app

INTERRUPTED = 130

app = typer.Typer(
    help="Compliance control for torque-controlled arms: run, measure, watch, plot.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
log_app = typer.Typer(help="Look into recorded logs.", no_args_is_help=True)
app.add_typer(log_app, name="log")
app.add_typer(experiment_app, name="experiment")
app.add_typer(identify_app, name="identify")
# into a pipe or file there is no width to keep to
console = Console(width=None if sys.stdout.isatty() else 120)

Out = Annotated[Path | None, typer.Option("--out", help="Folder for the results.")]
Buses = Annotated[
    list[str] | None, typer.Option("--bus", metavar="NAME=ADDR", help="Another bus address.")
]
Private = Annotated[
    bool, typer.Option("--private", help="In a network of its own, invisible to other terminals.")
]
LogPath = Annotated[Path, typer.Argument(help="A log, or the folder of a run.")]


@app.callback(invoke_without_command=True)
def _options(
    version: Annotated[bool, typer.Option("--version", help="Show the version and exit.")] = False,
) -> None:
    if version:
        console.print(f"limber {__version__}", highlight=False)
        raise typer.Exit


@app.command()
def demo(
    out: Out = None,
    seconds: Annotated[
        float | None, typer.Option(min=1.0, max=600.0, help="Stop after this much arm time.")
    ] = None,
    lockstep: Annotated[bool, typer.Option("--lockstep", help="No clock: repeatable.")] = False,
    no_watch: Annotated[
        bool, typer.Option("--no-watch", help="Without the live view, only the progress.")
    ] = False,
    private: Private = False,
) -> None:
    """The main job in a minute: a simulated arm on a CAN bus is pushed, its stiffness measured."""
    from limber import demo as module
    from limber.runner import RunOptions

    raise typer.Exit(
        module.demo(out, seconds, RunOptions(lockstep, watch=not no_watch), private, console)
    )


@app.command()
def run(
    scenario: Annotated[Path, typer.Argument(help="Scenario file (.yaml).")],
    out: Out = None,
    lockstep: Annotated[
        bool | None,
        typer.Option("--lockstep/--realtime", help="Instead of what the scenario says."),
    ] = None,
    bus: Buses = None,
    no_sim: Annotated[
        bool, typer.Option("--no-sim", help="A real arm (or another simulator) is on the bus.")
    ] = False,
    private: Private = False,
) -> None:
    """Run a scenario with the real processes, record it, measure it."""
    from limber import jobs

    options = jobs.RunRequest(scenario, out, lockstep, tuple(bus or ()), not no_sim, private)
    raise typer.Exit(jobs.run(options, console))


@app.command()
def lab(
    scenario: Annotated[Path, typer.Argument(help="Scenario file (.yaml).")],
    out: Out = None,
) -> None:
    """Run a scenario in one process, as fast as possible; the same bytes as run --lockstep."""
    from limber import jobs

    raise typer.Exit(jobs.lab(scenario, out, console))


@app.command()
def measure(
    folder: Annotated[Path, typer.Argument(help="Folder of a run.")],
) -> None:
    """Measure a recorded run again, from its log and scenario."""
    from limber import jobs

    raise typer.Exit(jobs.measure_again(folder, console))


@app.command()
def check(
    what: Annotated[str, typer.Argument(help="A robot's name or folder, a URDF, or a scenario.")],
    base: Annotated[str | None, typer.Option(help="Base link, for a bare URDF.")] = None,
    tip: Annotated[str | None, typer.Option(help="Tip link, for a bare URDF.")] = None,
) -> None:
    """Read a robot or scenario as the programs do; say what is wrong with it."""
    from limber import check as module

    raise typer.Exit(module.check(what, base, tip))


@app.command(
    "eval",
    context_settings={
        "ignore_unknown_options": True,
        "allow_extra_args": True,
        "help_option_names": [],
    },
)
def evaluate(context: typer.Context) -> None:
    """Evaluate control laws: a JSON file or standard input in, JSON out (see docs/eval.md)."""
    from limber.paths import program

    command = [str(program("limber-eval")), *context.args]
    os.execv(command[0], command)


@app.command()
def record(
    out: Annotated[Path, typer.Option("--out", help="Log file to write.")],
    duration: Annotated[
        float, typer.Option(min=0.0, max=1e6, help="Seconds; 0: until Ctrl-C.")
    ] = 0.0,
) -> None:
    """Record everything that is said, without loss, until Ctrl-C."""
    from limber.paths import output_folder, program

    output_folder(out.parent)
    command = [str(program("limber-record")), "--out", str(out), "--duration", str(duration)]
    os.execv(command[0], command)


@app.command()
def ask(
    entries: Annotated[
        list[str] | None,
        typer.Argument(help="Such as 'mode: active' or 'gains: {law: salisbury}'."),
    ] = None,
    robot: Annotated[str, typer.Option(help="The arm that runs: name or folder.")] = "openarm",
) -> None:
    """Say to a running stack what a scenario would say: mode, gains, goal, push, wall, ..."""
    from limber.network import require_multicast
    from limber.paths import program

    require_multicast()
    command = [str(program("limber-ask")), "--robot", robot, *(entries or [])]
    os.execv(command[0], command)


@log_app.command("info")
def log_info(path: LogPath) -> None:
    """What a log holds, what was lost, what is damaged."""
    from limber import log_commands

    log_commands.info(path, console)


@log_app.command("rate")
def log_rate(path: LogPath) -> None:
    """Rate and regularity of each channel."""
    from limber import log_commands

    log_commands.rate(path, console)


@log_app.command("echo")
def log_echo(
    path: LogPath,
    channel: Annotated[str, typer.Argument(help="Such as JOINT_STATE.")],
    field: Annotated[str | None, typer.Option(help="Only this field.")] = None,
    count: Annotated[int, typer.Option(min=1, help="This many messages.")] = 1,
    at: Annotated[float, typer.Option(min=0.0, help="From this arm time on, s.")] = 0.0,
) -> None:
    """Print messages, one field a line."""
    from limber import log_commands

    log_commands.echo(path, channel, field, count, at)


@log_app.command("convert")
def log_convert(
    path: LogPath,
    out: Annotated[
        Path, typer.Option("--out", help="FILE.npz, or a folder for one CSV a channel.")
    ],
) -> None:
    """To numpy (.npz) or CSV."""
    from limber import log_commands

    log_commands.convert(path, out, console)


@app.command()
def plot(
    path: LogPath,
    what: Annotated[
        list[str] | None,
        typer.Option(help="joint, cartesian, torque, spring or timing; default: all there is."),
    ] = None,
    out: Out = None,
) -> None:
    """Draw a log: one PNG a topic, and one interactive page that works offline."""
    from limber import plot as module

    module.plot(path, what or [], out, console)


@app.command()
def watch(
    robot: Annotated[str, typer.Option(help="For joint names and limits.")] = "openarm",
    once: Annotated[bool, typer.Option("--once", help="One picture, then exit.")] = False,
) -> None:
    """Live view: mode, joints, tip, faults, and what each channel is doing."""
    from limber import watch as module
    from limber.network import require_multicast
    from limber.robot import load_robot

    require_multicast()
    module.watch(load_robot(robot).joints, module.law_names(), once, console)


@app.command()
def doctor() -> None:
    """Look at what trips people: network, buffers, real time, CAN, disk. Says the cure."""
    from limber import doctor as module

    findings = module.examine()
    colors = {"ok": "green", "warn": "yellow", "fail": "bold red"}
    for finding in findings:
        mark = f"[{colors[finding.level]}]{finding.level:4}[/]"
        console.print(f"{mark} {finding.subject}: {finding.text}", highlight=False, soft_wrap=True)
        if finding.cure:
            console.print(f"       cure: {finding.cure}", highlight=False, soft_wrap=True)
    failed = any(finding.level == "fail" for finding in findings)
    raise typer.Exit(RUN_FAILED if failed else 0)


@app.command()
def test(
    part: Annotated[
        str | None,
        typer.Argument(help="One part: ctest, pytest, eval, system, vcan, format, lint."),
    ] = None,
) -> None:
    """All the tests, as CI runs them."""
    from limber import selftest

    passed = selftest.run(selftest.parts(part), console)
    raise typer.Exit(0 if passed else OUT_OF_TOLERANCE)


@app.command()
def bench() -> None:
    """Build the benchmarks in release mode and run them, each beside a peer."""
    from limber import bench as module

    raise typer.Exit(module.bench(console))


def fail(message: str, code: int) -> NoReturn:
    print(f"limber: {message}", file=sys.stderr)
    sys.exit(code)


def main() -> NoReturn:
    """Exit codes: 0 ok, 1 result out of tolerance, 2 wrong input, 3 run failed."""
    if os.environ.get("LIMBER_DEBUG") == "1":
        sys.exit(_call())
    try:
        sys.exit(_call())
    except TyperException as error:
        fail(_with_hint(error), WRONG_INPUT)
    except LimberError as error:
        fail(str(error), error.exit_code)
    except (KeyboardInterrupt, typer.Abort):
        fail("stopped", INTERRUPTED)
    except OSError as error:
        fail(f"{error.filename or ''}: {error.strerror or error}".lstrip(": "), RUN_FAILED)
    except Exception as error:
        text = " ".join(str(error).split())
        fail(f"{type(error).__name__}: {text} (LIMBER_DEBUG=1 shows where)", RUN_FAILED)


def _call() -> int:
    result = app(prog_name="limber", standalone_mode=False)
    return result if isinstance(result, int) else 0


def _with_hint(error: TyperException) -> str:
    """The parser's complaint on one line, with the help that would have told."""
    context = getattr(error, "ctx", None)
    path = context.command_path if context else "limber"
    text = " ".join(error.format_message().split())
    if not text:
        return f"a command is wanted. See {path} --help"
    return f"{text.rstrip('.?')}{'?' if text.endswith('?') else '.'} See {path} --help"
