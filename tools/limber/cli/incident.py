"""Commands that read black boxes: `limber incident ...`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from limber.cli.options import Out, console, names_of
from limber.errors import InputError

if TYPE_CHECKING:
    from limber.log.events import Names

app = typer.Typer(help="What the processes kept around a fault.", no_args_is_help=True)


@app.command("list")
def list_() -> None:
    """List the incidents that are kept, the oldest first."""
    from limber.log import incidents

    incidents.show_all(console)


@app.command()
def show(
    box: Annotated[
        Path | None, typer.Argument(help="A .box file; default: the newest incident.")
    ] = None,
    out: Out = None,
) -> None:
    """Tell what happened, in order; write all processes' last seconds as one LCM log."""
    from limber.log import incidents

    incidents.show(box, out, _names_of, console)


def _names_of(robot: str) -> "Names":
    """The joints of an arm that is not found by its name are numbered."""
    try:
        return names_of(robot)
    except InputError:
        return names_of(None)
