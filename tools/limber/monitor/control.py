"""The panel that controls the arm: mode, law and its numbers, built from the controller's list."""

import threading
import time
from typing import Any

import numpy as np
import viser

from limber.model.robot import Robot, read_yaml
from limber.monitor.feed import Feed
from limber.monitor.laws import Gain, Law, LawList
from limber.monitor.requests import Requests
from limber.monitor.widgets import Widget, make

GAINS_S = 0.1  # at most so often while a slider moves
SETTLED_S = 1.0  # after a request the controls follow the controller again
RAMP_S = 0.2
# Of the law in general, by what it follows; the rest is in the folder "more".
OF_POSE = ("K_x_translation_N_per_m", "K_x_rotation_Nm_per_rad", "damping_ratio")
OF_JOINTS = ("K_q_Nm_per_rad", "joint_damping_ratio")
LEFT_OUT = ("ramp_s", "K_x")  # sent with every request; the blocks say it


class ControlPanel:
    def __init__(
        self, gui: viser.GuiApi, robot: Robot, laws: LawList, requests: Requests, feed: Feed
    ) -> None:
        self._gui, self._robot, self._laws = gui, robot, laws
        self._requests, self._feed = requests, feed
        self._standard = read_yaml(robot.folder / "robot.yaml").get("gains") or {}
        self._lock = threading.Lock()  # callbacks come from the server's thread
        self._waiting: dict[str, Any] = {}
        self._sent_s = 0.0
        self.shown_law = ""
        self.widgets: dict[str, Widget] = {}
        self._folders: list[viser.GuiFolderHandle] = []
        self._build()

    def _build(self) -> None:
        gui = self._gui
        self._modes = gui.add_button_group("mode", ("hold", "active", "idle"))
        self._others = gui.add_button_group("", ("acknowledge", "release"))
        for group in (self._modes, self._others):

            @group.on_click
            async def _(event: viser.GuiEvent) -> None:
                self._requests.mode(event.target.value)

        self._law = gui.add_dropdown("law", tuple(self._laws.usable))
        self._summary = gui.add_markdown("")

        @self._law.on_update
        async def _(event: viser.GuiEvent) -> None:
            if event.client is not None and self._law.value in self._laws.usable:
                self._request("law", self._law.value)

        refused = [law for law in self._laws.laws if law.refusal]
        self._numbers = gui.add_folder("stiffness and damping")
        self._more = gui.add_folder("more", expand_by_default=False)
        if refused:
            with gui.add_folder("laws this arm cannot run", expand_by_default=False):
                gui.add_markdown("\n".join(f"- **{law.name}**: {law.refusal}" for law in refused))

    def draw(self) -> None:
        """Sends what waits, and shows what the controller has."""
        now = time.monotonic()
        with self._lock:
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
            self._law.value = law.name
        self._summary.content = law.summary
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
            self._gui, gain, start, self._robot.joint_names, self._request
        )

    def _request(self, key: str, value: Any) -> None:
        with self._lock:
            self._waiting[key] = value

    def _follow(self, status: np.void) -> None:
        """What CONTROLLER_STATUS carries of the gains."""
        K_x = np.diag(status["K_x"])
        self._show("K_x_translation_N_per_m", K_x[:3])
        self._show("K_x_rotation_Nm_per_rad", K_x[3:])
        self._show("K_q_Nm_per_rad", status["K_q"][: int(status["num_joints"])])

    def _show(self, key: str, value: np.ndarray) -> None:
        widget = self.widgets.get(key)
        if widget is not None and len(value) and np.isfinite(value).all():
            widget.show(value)
