"""STOP: a button in the panel, one that floats over the scene, and the space bar."""

import viser

from limber.monitor.requests import Requests

FIRST = -10
SAYS = (
    '<div style="font-size:0.75em;opacity:0.75;margin:0 12px 2px 12px"><span class="limber-roomy">'
    "STOP, or the space bar outside of a text field: the arm comes to rest and is held. </span>"
    "<b>No emergency stop</b>: that one cuts motor power.</div>"
)


class StopButtons:
    def __init__(self, gui: viser.GuiApi, requests: Requests) -> None:
        self._requests = requests
        self._add(gui, "STOP", FIRST)  # above all that changes its height
        gui.add_html(SAYS, order=FIRST + 1)
        panel = gui.add_panel()
        with panel.add_tab("stop"):
            self._add(gui, "STOP ", 0)
        panel.float(x=-12, y=-12, width=240)  # notes appear at the top
        command = gui.add_command("STOP", description="Bring the arm to rest", hotkey="space")

        @command.on_trigger
        async def _(_event: viser.CommandEvent) -> None:
            requests.stop()

    def _add(self, gui: viser.GuiApi, label: str, order: float) -> None:
        button = gui.add_button(label, color="red", icon=viser.Icon.HAND_STOP, order=order)

        @button.on_click
        async def _(_event: viser.GuiEvent) -> None:
            self._requests.stop()
