"""`limber lecture ...`: the claims of the lecture, and its laws as a calculator."""

import typer

from limber.cli.options import become
from limber_lecture import commands

app = typer.Typer(
    help="Measure the lecture's claims, evaluate its laws; only in a clone.", no_args_is_help=True
)
app.add_typer(commands.app, name="experiment")


@app.command(
    "eval",
    context_settings={
        "ignore_unknown_options": True,
        "allow_extra_args": True,
        "help_option_names": [],
    },
)
def evaluate(context: typer.Context) -> None:
    """Evaluate control laws: JSON from a file or standard input in, JSON out (lecture/eval.md)."""
    become("limber-eval", *context.args)
