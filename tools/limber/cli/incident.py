"""Commands that read black boxes: `limber incident ...`."""

from pathlib import Path
from typing import Annotated

import typer

from limber.cli.options import Out, console

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

    incidents.show(box, out, console)
