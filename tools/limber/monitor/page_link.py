"""What the page itself tells its server, beside viser's messages: that it lives, how large it is,
what was typed and which button was pressed. assets/page.js is the other end.

One WebSocket a page, of a protocol of its own. Whoever may open the page may send here, so each
message is short, checked, and dropped where it is none.
"""

import json
import threading
import time
from collections.abc import Callable
from typing import Any

from websockets.exceptions import ConnectionClosed

PROTOCOL = "limber-page"
LONGEST = 1000  # characters of a message
MOST_PER_S = 100  # messages of a page; others are dropped
Handler = Callable[[int, Any], None]


class PageLink:
    """Handlers are called in the server's thread, while it holds `turn`, with the number of the
    viewer (viser's client id) and the value of the message.
    """

    def __init__(self, turn: threading.RLock) -> None:
        self._turn = turn
        self._handlers: dict[str, Handler] = {}
        self._heard_s: dict[int, float] = {}
        self._slow: set[int] = set()
        self.dropped = 0

    def on(self, kind: str, handler: Handler) -> None:
        """`kind`: size, press or typed; the last handler counts."""
        self._handlers[kind] = handler

    def note_alive(self, viewer: int) -> None:
        self._heard_s[viewer] = time.monotonic()

    def draws_slowly(self, viewer: int) -> bool:
        """Without a graphics card, its page said: it gives its signs of life between drawings."""
        return viewer in self._slow

    def silent_s(self, viewer: int) -> float:
        """Since the viewer's page has given its last sign of life; infinite if it never did, or its
        page is closed.
        """
        return time.monotonic() - self._heard_s.get(viewer, -float("inf"))

    async def serve(self, connection: Any) -> None:
        """Until the page closes."""
        viewers: set[int] = set()
        second, taken = 0, 0
        try:
            async for text in connection:
                if int(time.monotonic()) != second:
                    second, taken = int(time.monotonic()), 0
                taken += 1
                if taken > MOST_PER_S or not self._take(text, viewers):
                    self.dropped += 1
        except ConnectionClosed:
            pass
        finally:
            for viewer in viewers:
                self._heard_s.pop(viewer, None)
                self._slow.discard(viewer)

    def _take(self, text: str | bytes, viewers: set[int]) -> bool:
        """False: this was no message."""
        if not isinstance(text, str) or len(text) > LONGEST:
            return False
        try:
            message = json.loads(text)
            viewer, kind, value = message["viewer"], message["kind"], message["value"]
        except (ValueError, KeyError, TypeError, RecursionError):
            return False
        if not isinstance(viewer, int) or not isinstance(kind, str):
            return False
        if kind == "alive":
            viewers.add(viewer)
            self.note_alive(viewer)
            if isinstance(value, dict) and value.get("software") is True:
                self._slow.add(viewer)
            return True
        try:
            with self._turn:
                self._handlers[kind](viewer, value)
        except (KeyError, TypeError, ValueError):  # of another kind, or with another content
            return False
        return True
