"""Each browser's own: how wide its panels are, and its number, which its page tells with all that
it sends.
"""

from typing import Any

import viser
from viser._messages import GuiSetPanelCollapsedMessage, GuiSetPanelWidthMessage

from limber.monitor.server import Server

CONTROL_PX, CHARTS_PX = 350, 430
RAIL_PX = 44  # of a folded panel
NARROWEST_CHARTS_PX = 260  # less is folded
SOFTWARE = "No graphics card found: drawn 5 times a second."
LAST = 1000  # below all else


def widths(window_px: int) -> tuple[int, int, bool]:
    """Of the control panel and the charts, and whether the charts are folded: the arm keeps half
    of the window at least.
    """
    half = window_px // 2
    control = min(CONTROL_PX, half - RAIL_PX)
    charts = min(CHARTS_PX, half - control)
    folded = charts < NARROWEST_CHARTS_PX
    return control, CHARTS_PX if folded else charts, folded


class Viewers:
    """`charts`: the panel beside the arm."""

    def __init__(self, server: Server, charts: viser.PanelHandle) -> None:
        self._server, self._charts = server, charts
        self._notes: dict[int, viser.GuiHtmlHandle] = {}
        self._layouts: dict[int, tuple[int, int, bool]] = {}
        server.link.on("size", self._size)
        server.scene.configure_default_lights(cast_shadow=False)  # until a graphics card is found

        @server.on_client_connect
        async def _(client: viser.ClientHandle) -> None:
            self._notes[client.client_id] = client.gui.add_html(
                note(client.client_id, False), order=LAST
            )

        @server.on_client_disconnect
        async def _(client: viser.ClientHandle) -> None:
            self._notes.pop(client.client_id, None)
            self._layouts.pop(client.client_id, None)

    def _size(self, viewer: int, size: Any) -> None:
        client = self._server.get_clients().get(viewer)
        if client is None:
            return
        software = bool(size["software"])
        self._notes[viewer].content = note(viewer, software)
        client.scene.configure_default_lights(cast_shadow=not software)
        layout = widths(min(max(int(size["width"]), 1), 100_000))
        if layout == self._layouts.get(viewer):
            return
        self._layouts[viewer] = layout
        control, charts, folded = layout
        if control > 0:
            client.gui.main_panel.set_width(control)
        self._place(client, charts, folded)

    def _place(self, client: viser.ClientHandle, width: float, folded: bool) -> None:
        """viser has no call that places a panel of all viewers for one of them."""
        gui, panel = client.gui, self._charts._placement_uuid
        send, run = gui._websock_interface.queue_message, gui._layout_run_id
        send(GuiSetPanelWidthMessage(panel, float(width), gui._next_layout_counter(), run))
        send(GuiSetPanelCollapsedMessage(panel, folded, gui._next_layout_counter(), run))


def note(viewer: int, software: bool) -> str:
    words = SOFTWARE if software else ""
    style = "font-size:0.75em;opacity:0.7;margin:0 12px;white-space:nowrap"
    return f'<div style="{style}" data-limber-viewer="{viewer}">{words}</div>'
