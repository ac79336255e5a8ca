"""Tables in the terminal, in one look."""

from typing import Any

from rich.table import Table

KINDS: dict[str, dict[str, Any]] = {
    "<": {"no_wrap": True},
    ">": {"no_wrap": True, "justify": "right"},
    "~": {},
}


def table(*columns: str, **style: Any) -> Table:
    """How a column's name begins tells what it holds: `<` words, `>` numbers, `~` long words."""
    look: dict[str, Any] = {
        "box": None,
        "padding": (0, 2, 0, 0),
        "header_style": "dim",
        "title_justify": "left",
    }
    made = Table(**{**look, **style})
    for column in columns:
        made.add_column(column[1:], **KINDS[column[0]])
    return made


def verdict(passed: bool | None) -> str:
    """None: nothing was expected."""
    return {None: "", True: "[green]ok[/]", False: "[bold red]NO[/]"}[passed]
