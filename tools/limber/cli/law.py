"""Commands for a control law of your own: `limber law ...`."""

import subprocess
from pathlib import Path
from typing import Annotated

import typer

from limber.cli.options import console
from limber.paths import program

app = typer.Typer(help="Write and check a control law of your own.", no_args_is_help=True)


@app.command(epilog="Example: limber law new my_law && limber law check my_law")
def new(
    name: Annotated[str, typer.Argument(help="Of the law: small letters, digits and _.")],
    out: Annotated[Path | None, typer.Option("--out", help="Folder; default: the name.")] = None,
) -> None:
    """Write a law that works, a spring at the tip, as one C++ file to be changed."""
    from limber.law import new as module

    for path in module.write(name, out):
        console.print(f"wrote {path}", soft_wrap=True)


@app.command(epilog="Example: limber law check my_law")
def check(
    law: Annotated[Path, typer.Argument(help="Folder of a law, or its shared library.")],
) -> int:
    """Compile a law and try it on random arms: memory, finite torques, energy."""
    from limber.law.build import law_file

    file = law_file(law)
    checked = subprocess.run([str(program("limber-check")), "law", str(file)], check=False)
    if checked.returncode == 0:
        console.print(f"to use it: export LIMBER_LAWS={file.resolve()}", soft_wrap=True)
        console.print("or in a scenario: `law_file: PATH`, relative to the file", soft_wrap=True)
    return checked.returncode
