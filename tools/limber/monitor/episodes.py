"""Episodes of what is being recorded, marked by buttons."""

import time
from collections.abc import Callable
from html import escape
from typing import Any

import viser

from limber.errors import LimberError
from limber.live.episodes import MARK, Episodes
from limber.monitor.feed import Batch
from limber.monitor.live_feed import LiveFeed

STYLE = "font-size:0.85em;line-height:1.3;margin:2px 12px 6px 12px"
NONE = "Marks go into the log of limber record."
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
        self._told, self._task = NONE, ""
        self._line = gui.add_html("")
        task = gui.add_text("task", "")
        self._button(gui, "start", lambda: self._episodes.start(task.value), "green")
        self._button(gui, "success", lambda: self._episodes.end(True))
        self._button(gui, "failure", lambda: self._episodes.end(False))
        self._button(gui, "drop", self._episodes.drop, "gray")

    def _button(
        self, gui: viser.GuiApi, label: str, mark: Callable[[], None], color: Any = None
    ) -> None:
        button = gui.add_button(label, color=color)

        @button.on_click
        def _(_event: viser.GuiEvent) -> None:  # in a thread of its own: it waits for the recorder
            try:
                mark()
            except LimberError as error:
                self._told = str(error)

    def draw(self, batch: Batch) -> None:
        for mark in batch.objects.get("EPISODE_KEPT", []):
            if mark.mark == MARK.MARK_START:
                self._task = f" ({mark.task})" if mark.task else ""
            word = WORDS.get(mark.mark, "marked")
            self._told = f"{time.strftime('%H:%M:%S')} episode{self._task} {word}"
        content = f'<div style="{STYLE}">{escape(self._told)}</div>'
        if content != self._line.content:
            self._line.content = content
