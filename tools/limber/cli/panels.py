"""The commands in `limber --help`, by what a person wants."""

from typing import Any

import typer
from typer.core import TyperGroup

PANELS = {
    "Run an arm": ("demo", "run", "lab", "sim", "service", "doctor"),
    "See what it does": ("monitor", "watch", "plot", "spy"),
    "Ask something of it": ("send",),
    "Describe an arm": ("new", "check", "directions", "identify", "export"),
    "Measure and judge": ("measure", "eval", "experiment", "faults", "referee"),
    "Record and read": ("record", "log", "replay", "can", "incident"),
    "Develop limber": ("test", "bench", "soak", "fuzz", "coverage", "mutation", "docs"),
}
PLACES = {name: place for place, name in enumerate(sum(PANELS.values(), ()))}


class InPanels(TyperGroup):
    """Commands stand in the order of PANELS."""

    def list_commands(self, ctx: Any) -> list[str]:
        return sorted(super().list_commands(ctx), key=lambda name: PLACES.get(name, len(PLACES)))


def put_in_panels(app: typer.Typer) -> None:
    """Each command of `app`, and of the groups without a name in it, into its panel."""
    panel_of = {name: panel for panel, names in PANELS.items() for name in names}
    for command in app.registered_commands:
        command.rich_help_panel = panel_of[command.name or command.callback.__name__]
    for group in app.registered_groups:
        if group.name:
            group.rich_help_panel = panel_of[group.name]
        else:
            put_in_panels(group.typer_instance)
