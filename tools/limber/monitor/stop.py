"""STOP: a button in the panel, one that floats over the scene, and the space bar."""

import viser

from limber.monitor.requests import Requests

FIRST = -10
SAYS = (
    '<div style="font-size:0.75em;opacity:0.75;margin:0 12px 4px 12px">'
    "STOP (also the space bar, unless a text field has the focus) brings the arm to rest; then it "
    "holds. It is <b>no emergency stop</b>: that one cuts motor power.</div>"
)


class StopButtons:
    def __init__(self, gui: viser.GuiApi, requests: Requests) -> None:
        self._requests = requests
        self._shown = ""
        self._add(gui, "STOP", FIRST)  # above all that changes its height
        self._result = gui.add_html(SAYS, order=FIRST + 1)
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

    def draw(self) -> None:
        """What became of the last one."""
        if self._requests.stop_state != self._shown:
            self._shown = self._requests.stop_state
            color = "#c62828" if "NOT" in self._shown else "#1a7f4b"
            style = f"color:{color};font-weight:700;margin:2px 12px"
            self._result.content = f'<div style="{style}">STOP: {self._shown}</div>{SAYS}'
