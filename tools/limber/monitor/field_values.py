"""What a browser says of a field counts only if the field could have that value: whoever opens a
WebSocket may send anything, and viser would keep it and show it to all.
"""

import math
from typing import Any

import viser
from viser import _messages
from viser.infra import ClientId

LONGEST_BYTES = 200  # of a text


def keep_possible(gui: viser.GuiApi) -> None:
    """Other values are dropped before viser sees them."""
    interface, take = gui._websock_interface, gui._handle_gui_updates

    async def checked(viewer: ClientId, message: _messages.GuiUpdateMessage) -> None:
        field = gui._gui_input_handle_from_uuid.get(message.uuid)
        updates = message.updates
        if field is None or not isinstance(updates, dict) or set(updates) != {"value"}:
            return
        if possible(field.value, getattr(field, "options", None), updates["value"]):
            await take(viewer, message)

    interface.unregister_handler(_messages.GuiUpdateMessage, take)
    interface.register_handler(_messages.GuiUpdateMessage, checked)


def possible(present: Any, options: Any, value: Any) -> bool:
    """`options`: of a field of choices. Numbers may be any: their limits are judged elsewhere, with
    a word for the user.
    """
    if options is not None:
        return isinstance(value, str) and value in options
    if isinstance(present, str):
        fits = isinstance(value, str) and value.isprintable()
        return fits and len(value.encode()) <= LONGEST_BYTES
    if isinstance(present, bool):
        return isinstance(value, bool)
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return number and isinstance(present, int | float) and math.isfinite(value)


def show(field: Any, value: object) -> None:
    """`field` is one of viser's, to whose values mypy finds no setter."""
    field.value = value
