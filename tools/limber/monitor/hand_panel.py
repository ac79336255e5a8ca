"""The hand's goal: width and greatest force, sent while a slider moves."""

import time

import viser

from limber.live.hand import PRESS_M
from limber.model.robot import HandInfo
from limber.monitor.feed import Feed
from limber.monitor.laws import Gain
from limber.monitor.requests import Requests
from limber.monitor.typed import TypedFields
from limber.monitor.widgets import make

SEND_S = 0.1  # at most so often while a slider moves
SETTLED_S = 1.0  # after a request the sliders follow the controller again
WORDS = {"width": "goal between the fingers; below 0 presses thin things", "force": "at most"}


class HandPanel:
    """`draw` is called in the server's turn, as its callbacks are (Server.turn)."""

    def __init__(
        self,
        gui: viser.GuiApi,
        hand: HandInfo,
        requests: Requests,
        feed: Feed,
        typed: TypedFields,
    ) -> None:
        self._requests, self._feed = requests, feed
        self._goal = {"width": 1e3 * float(hand.width_m.max()), "force": hand.hold_force_N}
        self._waits, self._sent_s = False, 0.0
        ends = {
            "width": ("mm", -1e3 * PRESS_M, self._goal["width"]),
            "force": ("N", 0.5, hand.force_limit_N),
        }
        self._widgets = {
            key: make(
                gui,
                Gain(key, WORDS[key], "number", unit, (), low, high, None),
                self._goal[key],
                [],
                self._asked,
                typed,
            )
            for key, (unit, low, high) in ends.items()
        }

    def _asked(self, key: str, value: float) -> None:
        self._goal[key], self._waits = value, True

    def draw(self) -> None:
        """Sends what waits, and shows the goal that the controller follows."""
        now = time.monotonic()
        if self._waits and now - self._sent_s > SEND_S:
            self._waits, self._sent_s = False, now
            self._requests.hand(1e-3 * self._goal["width"], self._goal["force"])
        settled = not self._waits and now - self._sent_s > SETTLED_S
        state = self._feed.newest.get("HAND_STATE")
        if state is None or not settled or not state["engaged"]:
            return
        followed = {"width": 1e3 * float(state["goal_width_m"])}
        if state["goal_force_N"] > 0:
            followed["force"] = float(state["goal_force_N"])
        for key, value in followed.items():
            self._goal[key] = value
            self._widgets[key].show(value)
