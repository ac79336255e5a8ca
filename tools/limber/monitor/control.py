"""The panel that controls the arm: law and numbers, from the controller's list. The modes'
buttons stand in the status card.
"""

import time
from html import escape
from typing import Any

import numpy as np
import viser

from limber.model.robot import Robot
from limber.monitor.feed import Feed
from limber.monitor.field_values import show
from limber.monitor.laws import Gain, Law, LawList
from limber.monitor.pending import REPORTED, UNITS, Pending, in_effect, several
from limber.monitor.requests import Requests
from limber.monitor.status_card import BUTTONS
from limber.monitor.typed import TypedFields
from limber.monitor.widgets import Widget, make

GAINS_S = 0.1  # at most so often while a slider moves
SETTLED_S = 1.0  # after a request the controls follow the controller again
RAMP_S = 0.2
# Of the law in general, by what it follows; the rest is in the folder "more".
OF_POSE = ("K_x_translation_N_per_m", "K_x_rotation_Nm_per_rad", "damping_ratio")
OF_JOINTS = ("K_q_Nm_per_rad", "joint_damping_ratio")
LEFT_OUT = ("ramp_s", "K_x")  # sent with every request; the blocks say it


WORDS = "font-size:0.85em;line-height:1.3;margin:0 12px 6px 12px"


def refused_law(law: Law) -> str:
    """HTML; the reason may name joints."""
    return f'<div style="{WORDS}"><b>{escape(law.name)}</b>: {escape(law.refusal)}</div>'


class ControlPanel:
    """`draw` is called in the server's turn, as its callbacks are (Server.turn)."""

    def __init__(
        self,
        gui: viser.GuiApi,
        robot: Robot,
        laws: LawList,
        requests: Requests,
        feed: Feed,
        typed: TypedFields,
        pending: Pending,
    ) -> None:
        self._gui, self._robot, self._laws = gui, robot, laws
        self._requests, self._feed = requests, feed
        self._typed, self._pending = typed, pending
        self._standard = robot.resolved["gains"]
        self._waiting: dict[str, Any] = {}
        self._sent_s = 0.0
        self.shown_law = ""
        self.widgets: dict[str, Widget] = {}
        self._folders: list[viser.GuiFolderHandle] = []
        self._build()

    def _build(self) -> None:
        gui = self._gui
        self._law = gui.add_dropdown("law", tuple(self._laws.usable))
        self._summary = gui.add_html("")

        @self._law.on_update
        async def _(event: viser.GuiEvent) -> None:
            if event.client is not None and self._law.value in self._laws.usable:
                self._request("law", self._law.value)

        refused = [law for law in self._laws.laws if law.refusal]
        self._numbers = gui.add_folder("stiffness and damping")
        self._more = gui.add_folder("more", expand_by_default=False)
        if refused:
            with gui.add_folder("laws this arm cannot run", expand_by_default=False):
                gui.add_html("".join(map(refused_law, refused)))

    def pressed(self, _viewer: int, word: Any) -> None:
        """A button of the status card."""
        if word in BUTTONS:
            self._requests.mode(word)

    def draw(self) -> None:
        """Sends what waits, and shows what the controller has."""
        now = time.monotonic()
        if self._waiting and now - self._sent_s > GAINS_S:
            values, self._waiting = self._waiting, {}
            self._sent_s = now
            self._requests.gains(values, RAMP_S)
        settled = not self._waiting and now - self._sent_s > SETTLED_S
        status = self._feed.newest.get("CONTROLLER_STATUS")
        if status is None or not settled:
            return
        law = self._laws.law(int(status["law"]))
        if law is not None and law.name != self.shown_law:
            self._show_law(law)
        self._follow(status)

    def settle(self) -> None:
        """Follow the controller again at once."""
        self._sent_s = -np.inf

    def _show_law(self, law: Law) -> None:
        """The numbers that mean something to this law first."""
        self.shown_law = law.name
        if law.name in self._laws.usable:
            show(self._law, law.name)
        self._summary.content = f'<div style="{WORDS}">{escape(law.summary)}</div>'
        for widget_folder in self._folders:
            widget_folder.remove()
        first = OF_POSE if law.goal == "pose" else OF_JOINTS if law.goal != "none" else ()
        self.widgets = {}
        with self._numbers:
            top = self._gui.add_folder(None)
        with self._more:
            rest = self._gui.add_folder(None)
        self._folders = [top, rest]
        with top:
            for gain in (*(g for g in self._laws.gains if g.key in first), *law.parameters):
                self._add(gain)
        with rest:
            for gain in self._laws.gains:
                if gain.key not in self.widgets and gain.key not in LEFT_OUT:
                    self._add(gain)

    def _add(self, gain: Gain) -> None:
        start = gain.standard
        if start == "robot.yaml":
            start = self._standard.get(gain.key, gain.low)
        self.widgets[gain.key] = make(
            self._gui, gain, start, self._robot.joint_names, self._request, self._typed
        )

    def _request(self, key: str, value: Any) -> None:
        self._waiting[key] = value

    def _follow(self, status: np.void) -> None:
        """What CONTROLLER_STATUS carries of the gains; where another value waits for ACTIVE, that
        one, with the one in effect beside it.
        """
        for key in REPORTED:
            widget, now = self.widgets.get(key), in_effect(status, key)
            if widget is None or now is None or not len(now) or not np.isfinite(now).all():
                continue
            value = self._pending.values.get(key)
            waits = value is not None and not np.allclose(value, now, rtol=1e-3)
            words = f"With active; now {several(now)} {UNITS[key]}." if waits else ""
            widget.show(value if waits else now, words)
