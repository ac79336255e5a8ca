"""The `limber` program: puts the groups of commands together and reports errors in one line."""

import io
import os
import stat
import sys
from importlib import import_module
from importlib.util import find_spec
from typing import Annotated, Any, NoReturn

import typer

from limber.cli import (
    black_box,
    can,
    doctor,
    export,  # noqa: F401 - fills groups.export
    groups,
    identify,  # noqa: F401 - fills groups.identify
    joint_check,  # noqa: F401 - fills groups.identify
    law,
    live,
    log,
    monitor,
    motors,
    run,
    sweep,  # noqa: F401 - fills groups.identify
)
from limber.cli.options import console
from limber.cli.panels import Commands, put_in_panels
from limber.errors import RUN_FAILED, WRONG_INPUT, LimberError
from limber.paths import CMAKE, command_for

INTERRUPTED = 130
# What a wrong command line raises, just below Exception: TyperException, or click's in a typer that
# is built on it, as Debian 13's is.
PARSER_ERROR: Any = typer.BadParameter.__mro__[-4]

app = typer.Typer(
    cls=Commands,
    help="Compliance control for torque-controlled arms: run, measure, watch, plot.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
for module in (run, doctor, live, monitor, log):
    app.add_typer(module.app)
groups.log.add_typer(black_box.app, name="black-box")
app.add_typer(groups.log, name="log")
app.add_typer(groups.identify, name="identify")
app.add_typer(groups.export, name="export")
can.app.add_typer(motors.app, name="motors")
app.add_typer(can.app, name="can")
put_in_panels(app)
app.add_typer(law.app, name="law", hidden=True)
app.info.epilog = (
    "Beside these: limber first-hour (with a real arm), limber law (a control law of your own), "
    "limber motors (those on a bus), limber ros2 (for ROS 2), limber sweep (many runs)."
)
# What proves limber and what teaches it lies beside a clone's sources, and is not installed.
IN_A_CLONE = {"dev": "limber_qa.cli", "lecture": "limber_lecture.cli"}
for name, package in IN_A_CLONE.items():
    if find_spec(package.partition(".")[0]):
        app.add_typer(import_module(package).app, name=name, hidden=True)
if find_spec("limber_qa"):
    app.info.epilog += " Of this clone: limber test, limber dev, limber lecture."


@app.callback(invoke_without_command=True)
def _options(
    version: Annotated[bool, typer.Option("--version", help="Show the version and exit.")] = False,
    cmake: Annotated[
        bool, typer.Option("--cmake-dir", help="Show where find_package(limber) looks, and exit.")
    ] = False,
) -> None:
    if cmake:
        print(CMAKE)
        raise typer.Exit
    if version:
        from limber import __version__

        console.print(f"limber {__version__}")
        raise typer.Exit


def fail(message: str, code: int) -> NoReturn:
    print(f"limber: {message}", file=sys.stderr)
    sys.exit(code)


def complaint(error: ImportError) -> str:
    """Of a package that is not there, or cannot be loaded: the command that installs it."""
    name = (error.name or "").partition(".")[0]
    if command := command_for(name):
        return f"this needs the package {error.name}: {command}"
    return f"{error} (LIMBER_DEBUG=1 shows where)"


def main() -> NoReturn:
    """Exit codes: 0 ok, 1 result out of tolerance, 2 wrong input, 3 run failed."""
    os.umask(os.umask(0) | stat.S_IWOTH)  # as common/program.cc
    if isinstance(sys.stdout, io.TextIOWrapper):  # a terminal that does not know ± gets a ?
        sys.stdout.reconfigure(errors="replace")
    if os.environ.get("LIMBER_DEBUG") == "1":
        sys.exit(_call())
    try:
        sys.exit(_call())
    except PARSER_ERROR as error:
        fail(_with_hint(error), WRONG_INPUT)
    except LimberError as error:
        fail(str(error), error.exit_code)
    except (KeyboardInterrupt, typer.Abort):
        fail("stopped", INTERRUPTED)
    except ImportError as error:
        fail(complaint(error), RUN_FAILED)
    except OSError as error:
        fail(f"{error.filename or ''}: {error.strerror or error}".lstrip(": "), RUN_FAILED)
    except Exception as error:
        text = " ".join(str(error).split())
        fail(f"{type(error).__name__}: {text} (LIMBER_DEBUG=1 shows where)", RUN_FAILED)


def _call() -> int:
    result = app(prog_name="limber", standalone_mode=False)
    return result if isinstance(result, int) else 0


def _with_hint(error: Any) -> str:
    """The parser's complaint on one line, and the command that shows the help."""
    context = getattr(error, "ctx", None)
    path = context.command_path if context else "limber"
    text = " ".join(error.format_message().split()) or "missing command"
    if text.startswith("No such command") and "Did you mean" not in text:
        from limber.live.meant import meant

        if command := meant(next(iter(sys.argv[1:]), "")):
            return f"{text.rstrip('.?')}. Try: {command}"
    return f"{text.rstrip('.?')}{'?' if text.endswith('?') else '.'} See {path} --help"
