"""The page: scene, status card and charts, drawn from a feed in one loop."""

import time

import numpy as np
import viser

from limber.live.arm_state import targets_of
from limber.live.hand import hand_text
from limber.messages import constants
from limber.model.robot import Robot
from limber.monitor.answers import Answers
from limber.monitor.charts import HISTORY_S, ChartPanel, Keeper
from limber.monitor.feed import Batch, Feed
from limber.monitor.guard import Guard
from limber.monitor.laws import LawList
from limber.monitor.pending import Pending
from limber.monitor.requests import Outcome
from limber.monitor.scene import Scene
from limber.monitor.server import Server
from limber.monitor.status_card import Shown, StatusCard
from limber.monitor.viewers import CHARTS_PX, CONTROL_PX, Viewers
from limber.monitor.walls import WallChange
from limber.monitor.words import Situation, mode_of, situation

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
        self.control = False  # the page may move the arm
        self.answers, self.pending = Answers(), Pending()
        self._told: dict[str, float] = {}
        self._stop = (0, "")
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
        self._for_charts = Batch()  # for the charts
        self._limits: list[tuple[float, int]] = []

    def add_charts(self) -> None:
        panel = self.server.gui.add_panel()
        with panel.add_tab("charts"):
            self.charts = ChartPanel(self.server.gui, self.keeper, WINDOWS_S)

        @self.server.on_client_connect
        async def _(_client: viser.ClientHandle) -> None:
            self.charts.make_again()

        panel.dock_right()
        panel.set_width(CHARTS_PX)
        self.server.gui.main_panel.set_width(CONTROL_PX)
        self.server.gui.main_panel.dock_left()
        Viewers(self.server, panel)

    def draw(self) -> Batch:
        """One picture: takes what has arrived, shows it and gives it on."""
        now = time.monotonic()
        batch = self.feed.take()
        self._note_limits(batch, now)
        self._for_charts.add(batch)
        self.pending.note(batch, self.feed.newest.get("CONTROLLER_STATUS"))
        if now - self._kept_s > CHARTS_S:
            self._kept_s = now
            self.guard(self.keeper.add, self._for_charts)
            self._for_charts = Batch()
        limits = int(np.bitwise_or.reduce([bits for _, bits in self._limits] or [0]))
        words = situation(self.feed, self.robot.joint_names, limits)
        if self.server.get_clients():
            self._show(words, batch, now)
        return batch

    def _show(self, words: Situation, batch: Batch, now: float) -> None:
        old = words.headline.startswith("NO ")
        with self.server.atomic():
            self.guard(self.scene.draw, self.feed, batch, old)
            self.guard(self.card.show, self._shown(words))
        if now - self._charts_s > CHARTS_S:
            self._charts_s = now
            self.guard(self.charts.draw)

    def _shown(self, words: Situation) -> Shown:
        status = self.feed.newest.get("CONTROLLER_STATUS")
        pending = [] if status is None else self.pending.words(status, self._law_name(status))
        return Shown(
            words,
            self._facts(),
            [*self.feed.troubles(), *self._hints()],
            pending,
            self.answers.shown(words.mode),
            self.control,
            self._lines(),
        )

    def tell(self, outcomes: list[Outcome]) -> None:
        """What was refused: in the panel, and for a moment on every viewer's screen."""
        for outcome in outcomes:
            title = f"{outcome.kind} refused"
            self.answers.note(outcome.kind, outcome.text, False, mode_of(self.feed))
            if outcome.text:
                self._announce(title, outcome.text)

    def tell_stop(self, number: int, state: str) -> None:
        """`state`: what became of the stop with this number, the last one."""
        if (number, state) == self._stop:
            return
        self._stop = number, state
        self.answers.note("STOP", state, "NOT" not in state, mode_of(self.feed))

    def tell_typed(self, name: str, words: str, good: bool) -> None:
        """What became of a number that was typed."""
        self.answers.note(name, words, good, mode_of(self.feed))
        self._announce(name, words)

    def _announce(self, title: str, words: str) -> None:
        """One line; the same words once in a while. The whole stands in the panel."""
        now = time.monotonic()
        if now - self._told.get(words, -TELL_AGAIN_S) < TELL_AGAIN_S:
            return
        self._told = {w: at for w, at in self._told.items() if now - at < TELL_AGAIN_S}
        self._told[words] = now
        for client in self.server.get_clients().values():
            client.add_notification(title, words, color="red", auto_close_seconds=TOLD_S)

    def _note_limits(self, batch: Batch, now: float) -> None:
        bits = batch.read("CONTROLLER_STATUS")["limits"]
        if len(bits) and np.bitwise_or.reduce(bits):
            self._limits.append((now, int(np.bitwise_or.reduce(bits))))
        self._limits = [entry for entry in self._limits if now - entry[0] < LIMITS_S]

    def _facts(self) -> list[str]:
        state, status = (self.feed.newest.get(c) for c in ("JOINT_STATE", "CONTROLLER_STATUS"))
        facts = []
        if status is not None:
            facts.append(self._law_name(status))
        if state is not None:
            drive = constants("joint_state_t", "DRIVE_").get(int(state["drive_state"]), "UNKNOWN")
            facts.append(f"drives {drive.replace('HOLD', 'FALLBACK')}")
            facts.append(f"{float(state['time_ns']) * 1e-9:.0f} s")
        return facts

    def _lines(self) -> list[str]:
        """Hand and targets, of an arm that has a hand and of one that targets were sent to."""
        hand, status = (self.feed.newest.get(c) for c in ("HAND_STATE", "CONTROLLER_STATUS"))
        lines = [] if hand is None else [hand_text(hand)]
        if status is not None:
            targets = targets_of(status)
            if targets.state != "none" or targets.taken or targets.refused:
                lines.append(str(targets))
        return lines

    def _law_name(self, status: np.void) -> str:
        law = self.laws.law(int(status["law"]))
        return f"law number {int(status['law'])}" if law is None else law.name

    def _hints(self) -> list[str]:
        hints = [f"Not drawn: {trouble}" for trouble in self.scene.figure.troubles]
        if self.other_arm:
            hints.append(
                f"The running arm is {self.other_arm}, this page is of {self.robot.name}: "
                "start limber monitor without --robot."
            )
        lead = "A part of this page failed, and what it shows may be old:"
        return [*hints, *(f"{lead} {fault}" for fault in self.guard.faults)]
