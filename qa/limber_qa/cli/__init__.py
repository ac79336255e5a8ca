"""What `limber dev` has in a clone."""

from limber_qa.cli import check_trace, faults
from limber_qa.cli.dev import app

app.add_typer(check_trace.app)
app.add_typer(faults.app, name="faults")
