"""Episodes of what is being recorded, marked by buttons."""

import time
from collections.abc import Callable
from html import escape

import viser

from limber.errors import LimberError
from limber.live.episodes import MARK, Episodes
from limber.monitor.feed import Batch
from limber.monitor.live_feed import LiveFeed

STYLE = "font-size:0.85em;line-height:1.3;margin:2px 12px 6px 12px"
NONE = "Marks go into the log of limber log record."
WAITS = "The mark is on its way."
WORDS = {
    MARK.MARK_START: "runs",
    MARK.MARK_SUCCESS: "ended: success",
    MARK.MARK_FAILURE: "ended: failure",
    MARK.MARK_DROP: "dropped",
    MARK.MARK_KEEP: "kept",
}


class EpisodePanel:
    """Shows what recorders have kept, whoever has set the mark."""

    def __init__(self, gui: viser.GuiApi, feed: LiveFeed) -> None:
        self._episodes = Episodes(feed.receiver)
        self._told, self._name = NONE, ""
        self._line = gui.add_html("")
        self._task = gui.add_text("task", "")
        self.buttons = {
            "start": gui.add_button("start", color="green"),
            "success": gui.add_button("success"),
            "failure": gui.add_button("failure"),
            "drop": gui.add_button("drop", color="gray"),
        }
        self._on("start", lambda: self._episodes.start(self._task.value))
        self._on("success", lambda: self._episodes.end(True))
        self._on("failure", lambda: self._episodes.end(False))
        self._on("drop", self._episodes.drop)

    def _on(self, label: str, mark: Callable[[], None]) -> None:
        @self.buttons[label].on_click
        def _(_event: viser.GuiEvent) -> None:  # in a thread of its own: it waits for the recorder
            self._told = WAITS
            try:
                mark()
            except LimberError as error:
                self._told = str(error)

    def draw(self, batch: Batch) -> None:
        for mark in batch.objects.get("EPISODE_KEPT", []):
            if mark.mark == MARK.MARK_START:
                self._name = f" ({mark.task})" if mark.task else ""
            word = WORDS.get(mark.mark, "marked")
            self._told = f"{time.strftime('%H:%M:%S')} episode{self._name} {word}"
        content = f'<div style="{STYLE}">{escape(self._told)}</div>'
        if content != self._line.content:
            self._line.content = content
