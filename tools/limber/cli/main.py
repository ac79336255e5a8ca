"""The `limber` program: puts the groups of commands together and reports errors in one line."""

import io
import os
import stat
import sys
from typing import Annotated, NoReturn

import typer
from typer.exceptions import TyperException

from limber import __version__
from limber.cli import (
    can,
    dev,
    directions,
    experiment,
    export,
    faults,
    identify,
    incident,
    live,
    log,
    monitor,
    referee,
    run,
)
from limber.cli.options import console
from limber.cli.panels import InPanels, put_in_panels
from limber.errors import RUN_FAILED, WRONG_INPUT, LimberError

INTERRUPTED = 130

app = typer.Typer(
    cls=InPanels,
    help="Compliance control for torque-controlled arms: run, measure, watch, plot.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
for group in (run, directions, live, monitor, log, referee, dev):
    app.add_typer(group.app)
app.add_typer(can.app, name="can")
app.add_typer(experiment.app, name="experiment")
app.add_typer(export.app, name="export")
app.add_typer(faults.app, name="faults")
app.add_typer(identify.app, name="identify")
app.add_typer(incident.app, name="incident")
put_in_panels(app)


@app.callback(invoke_without_command=True)
def _options(
    version: Annotated[bool, typer.Option("--version", help="Show the version and exit.")] = False,
) -> None:
    if version:
        console.print(f"limber {__version__}")
        raise typer.Exit


def fail(message: str, code: int) -> NoReturn:
    print(f"limber: {message}", file=sys.stderr)
    sys.exit(code)


def main() -> NoReturn:
    """Exit codes: 0 ok, 1 result out of tolerance, 2 wrong input, 3 run failed."""
    os.umask(os.umask(0) | stat.S_IWOTH)  # as common/program.cc
    if isinstance(sys.stdout, io.TextIOWrapper):  # a terminal that does not know ± gets a ?
        sys.stdout.reconfigure(errors="replace")
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
    """The parser's complaint on one line, and the command that shows the help."""
    context = getattr(error, "ctx", None)
    path = context.command_path if context else "limber"
    text = " ".join(error.format_message().split()) or "missing command"
    if text.startswith("No such command") and "Did you mean" not in text:
        from limber.live.meant import meant

        if command := meant(next(iter(sys.argv[1:]), "")):
            return f"{text.rstrip('.?')}. Try: {command}"
    return f"{text.rstrip('.?')}{'?' if text.endswith('?') else '.'} See {path} --help"
