"""The commands in `limber --help`, by what a person wants, and the words that they had before."""

from typing import TYPE_CHECKING, Any

import typer
from typer.core import TyperGroup

if TYPE_CHECKING:
    from typer._click.core import Command  # typer's own click: no other is installed with limber

PANELS = {
    "Run an arm": ("demo", "run", "lab", "sim", "doctor"),
    "See what it does": ("monitor", "watch", "plot"),
    "Ask something of it": ("send",),
    "Describe an arm and measure it": ("new", "check", "identify", "export"),
    "Record and read": ("log", "can"),
}
PLACES = {name: place for place, name in enumerate(sum(PANELS.values(), ()))}

# What the last line of `limber --help` names; each works by its full name, too.
SHORTER = {
    "first-hour": "identify first-hour",
    "motors": "can motors",
    "ros2": "export ros2",
    "sweep": "identify sweep",
    "test": "dev test",
}
# As they were called in the version before: they work and are not shown.
BEFORE = {
    "record": "log record",
    "replay": "log replay",
    "spy": "log spy",
    "measure": "log measure",
    "incident": "log black-box",
    "directions": "identify joints",
    "service": "export service",
    "experiment": "lecture experiment",
    "eval": "lecture eval",
    "referee": "dev check-trace",
    **{
        name: f"dev {name}"
        for name in ("bench", "soak", "fuzz", "coverage", "mutation", "docs", "faults")
    },
}
ELSEWHERE = {**SHORTER, **BEFORE}


class Commands(TyperGroup):
    """Commands stand in the order of PANELS; those that are ELSEWHERE are found here, too."""

    def list_commands(self, ctx: Any) -> list[str]:
        return sorted(super().list_commands(ctx), key=lambda name: PLACES.get(name, len(PLACES)))

    def get_command(self, ctx: Any, name: str) -> "Command | None":
        group, _, inside = ELSEWHERE.get(name, name).partition(" ")
        found = super().get_command(ctx, group)
        return found.get_command(ctx, inside) if inside and isinstance(found, TyperGroup) else found


def put_in_panels(app: typer.Typer) -> None:
    """Each command of `app`, and of the groups without a name in it, into its panel."""
    panel_of = {name: panel for panel, names in PANELS.items() for name in names}
    for command in app.registered_commands:
        function = command.callback
        name = command.name or (function.__name__ if function is not None else "")
        command.rich_help_panel = panel_of[name]
    for group in app.registered_groups:
        if group.name:
            group.rich_help_panel = panel_of[group.name]
        elif group.typer_instance is not None:
            put_in_panels(group.typer_instance)
