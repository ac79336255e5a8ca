"""The terminal during the check: lines that stay, and below them a picture that changes."""

import time
from typing import Self

from rich.console import Console, RenderableType
from rich.live import Live

STAYS_S = 1.0


class Screen:
    """Context manager. Without a terminal there is no picture, but its words, each time that they
    change and stay for a second.
    """

    def __init__(self, console: Console) -> None:
        self._console = console
        self._live = Live(console=console, auto_refresh=False, transient=True)
        self._words, self._since_s, self._told = "", 0.0, ""

    def __enter__(self) -> Self:
        if self._console.is_terminal:
            self._live.start()
        return self

    def __exit__(self, *_error: object) -> None:
        if self._live.is_started:
            self._live.update("", refresh=True)
            self._live.stop()

    def tell(self, text: str, style: str = "") -> None:
        """A line that stays; what was shown before it may come again."""
        self._told = ""
        self._console.print(text, style=style, markup=False, highlight=False, soft_wrap=True)

    def show(self, picture: RenderableType, words: str, at_once: bool = False) -> None:
        """`words`: what the picture has to tell where there is none."""
        if self._live.is_started:
            self._live.update(picture, refresh=True)
            return
        if words != self._words:
            self._words, self._since_s = words, time.monotonic()
        stays = at_once or time.monotonic() - self._since_s > STAYS_S
        if stays and words != self._told:
            self.tell(words)
            self._told = words
