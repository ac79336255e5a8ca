"""The page: scene, status card and charts, drawn from a feed in one loop."""

import time

import numpy as np
import viser

from limber.messages import constants
from limber.model.robot import Robot
from limber.monitor.charts import HISTORY_S, ChartPanel, Keeper
from limber.monitor.feed import Batch, Feed
from limber.monitor.guard import Guard
from limber.monitor.laws import LawList
from limber.monitor.requests import Outcome
from limber.monitor.scene import Scene
from limber.monitor.server import Server
from limber.monitor.status_card import StatusCard
from limber.monitor.walls import WallChange
from limber.monitor.words import Situation, situation

DRAW_S = 1 / 30
CHARTS_S = 1 / 10
WINDOWS_S = (10.0, 3.0, HISTORY_S)
TELL_AGAIN_S, TOLD_S = 3.0, 10.0
LIMITS_S = 1.0  # a limit that acted within this time is shown


class Page:
    """What the page of a running arm and that of a log have in common."""

    def __init__(
        self,
        server: Server,
        robot: Robot,
        laws: LawList,
        feed: Feed,
        walls: list[WallChange],
        guard: Guard,
    ) -> None:
        self.guard = guard
        self.server, self.robot, self.feed, self.laws = server, robot, feed, laws
        self.other_arm = ""  # name of an arm that runs and is not the one drawn
        self._told: dict[str, float] = {}
        server.gui.configure_theme(
            control_width="medium",
            show_logo=False,
            show_share_button=False,
            brand_color=(31, 119, 220),
        )
        server.gui.set_panel_label(f"limber · {robot.name}")
        self.scene = Scene(server, robot, laws.uses_K_x, walls)
        self.card = StatusCard(server.gui)
        self.keeper = Keeper(robot.joint_names, WINDOWS_S)
        self._kept_s = self._charts_s = 0.0
        self._pending = Batch()  # for the charts
        self._limits: list[tuple[float, int]] = []

    def add_charts(self) -> None:
        panel = self.server.gui.add_panel()
        with panel.add_tab("charts"):
            self.charts = ChartPanel(self.server.gui, self.keeper, WINDOWS_S)

        @self.server.on_client_connect
        async def _(_client: viser.ClientHandle) -> None:
            self.charts.make_again()

        panel.dock_right()
        panel.set_width(430)
        self.server.gui.main_panel.set_width(350)
        self.server.gui.main_panel.dock_left()

    def draw(self) -> Batch:
        """One picture: takes what has arrived, shows it and gives it on."""
        now = time.monotonic()
        batch = self.feed.take()
        self._note_limits(batch, now)
        self._pending.add(batch)
        if now - self._kept_s > CHARTS_S:
            self._kept_s = now
            self.guard(self.keeper.add, self._pending)
            self._pending = Batch()
        limits = int(np.bitwise_or.reduce([bits for _, bits in self._limits] or [0]))
        words = situation(self.feed, self.robot.joint_names, limits)
        if self.server.get_clients():
            self._show(words, batch, now)
        return batch

    def _show(self, words: Situation, batch: Batch, now: float) -> None:
        old = words.headline.startswith("NO ")
        with self.server.atomic():
            self.guard(self.scene.draw, self.feed, batch, old)
            hints = [*self.feed.troubles(), *self._hints()]
            self.guard(self.card.show, words, self._facts(), hints)
        if now - self._charts_s > CHARTS_S:
            self._charts_s = now
            self.guard(self.charts.draw)

    def tell(self, outcomes: list[Outcome]) -> None:
        """What was refused, on every viewer's screen; the same words once in a while."""
        now = time.monotonic()
        for outcome in outcomes:
            if not outcome.text or now - self._told.get(outcome.text, -TELL_AGAIN_S) < TELL_AGAIN_S:
                continue
            self._told[outcome.text] = now
            for client in self.server.get_clients().values():
                title = f"{outcome.kind}: refused"
                client.add_notification(title, outcome.text, color="red", auto_close_seconds=TOLD_S)

    def _note_limits(self, batch: Batch, now: float) -> None:
        bits = batch.read("CONTROLLER_STATUS")["limits"]
        if len(bits) and np.bitwise_or.reduce(bits):
            self._limits.append((now, int(np.bitwise_or.reduce(bits))))
        self._limits = [entry for entry in self._limits if now - entry[0] < LIMITS_S]

    def _facts(self) -> list[str]:
        state, status = (self.feed.newest.get(c) for c in ("JOINT_STATE", "CONTROLLER_STATUS"))
        facts = []
        if status is not None:
            law = self.laws.law(int(status["law"]))
            facts.append(f"law number {int(status['law'])}" if law is None else law.name)
        if state is not None:
            drive = constants("joint_state_t", "DRIVE_").get(int(state["drive_state"]), "UNKNOWN")
            facts.append(f"drives {drive.replace('HOLD', 'FALLBACK')}")
            facts.append(f"{float(state['time_ns']) * 1e-9:.0f} s")
        return facts

    def _hints(self) -> list[str]:
        hints = [f"Not drawn: {trouble}" for trouble in self.scene.figure.troubles]
        if self.other_arm:
            hints.append(
                f"The running arm is {self.other_arm}, this page is of {self.robot.name}: "
                "start limber monitor without --robot."
            )
        lead = "A part of this page failed, and what it shows may be old:"
        return [*hints, *(f"{lead} {fault}" for fault in self.guard.faults)]
