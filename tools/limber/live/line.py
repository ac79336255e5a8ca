"""One LCM plane for one process: heard by limber's own receiver, sent to by LCM's library."""

from collections.abc import Callable
from typing import Any
from urllib.parse import urlsplit

from limber.errors import RunError
from limber.lcm_package import lcm_package
from limber.live.network import CURE
from limber.live.plane_receiver import PlaneReceiver

GROUP, PORT = "239.255.76.67", 7667  # LCM's own

Handler = Callable[[str, bytes], None]


class Line:
    """`url`: udpm://[GROUP[:PORT]]?ttl=0. For one thread, publish() apart, which any may call.

    Hears nothing before the first subscribe(), and loads LCM at the first publish(): who only
    listens needs none. RunError at another address.
    """

    def __init__(self, url: str) -> None:
        self._group, self._port = _place(url)
        self._url = url
        self._sender: Any = None
        self._receiver: PlaneReceiver | None = None
        self._handlers: dict[str, list[Handler]] = {}

    def subscribe(self, channel: str, handler: Handler) -> tuple[str, Handler]:
        """Calls `handler(channel, message)` in handle_timeout() for each message on `channel` from
        here on, however many they are. What is returned is for unsubscribe().
        """
        if self._receiver is None:
            self._receiver = PlaneReceiver(self._group, self._port)
        self._handlers.setdefault(channel, []).append(handler)
        self._receiver.hear(channel)
        return channel, handler

    def unsubscribe(self, subscription: tuple[str, Handler]) -> None:
        channel, handler = subscription
        self._handlers[channel].remove(handler)
        if not self._handlers[channel] and self._receiver is not None:
            self._receiver.forget(channel)

    def handle_timeout(self, timeout_ms: float) -> int:
        """Handles all that has come; waits for it, at most so long. How many messages it was."""
        if self._receiver is None or not self._receiver.wait(timeout_ms / 1000):
            return 0
        messages = self._receiver.take()
        for channel, message in messages:
            for handler in tuple(self._handlers[channel]):
                handler(channel, message)
        return len(messages)

    def malformed(self) -> int:
        """Datagrams that are no messages of LCM's, and were left out."""
        return 0 if self._receiver is None else self._receiver.malformed()

    def publish(self, channel: str, data: bytes) -> None:
        """Raises RunError without a multicast route, or without LCM."""
        if self._sender is None:
            try:
                # Without a subscription it opens no socket to receive.
                self._sender = lcm_package().LCM(self._url)
            except RuntimeError as error:
                raise RunError(f"LCM finds no multicast route: {CURE}") from error
        self._sender.publish(channel, data)

    def close(self) -> None:
        """Nothing more is heard."""
        self._handlers.clear()
        if self._receiver is not None:
            self._receiver.close()
            self._receiver = None


def _place(url: str) -> tuple[str, int]:
    parts = urlsplit(url)
    try:
        port = parts.port
    except ValueError:
        port = 0
    if parts.scheme != "udpm" or port == 0:
        raise RunError(f"LCM address {url}: expected udpm://GROUP:PORT?ttl=0")
    return parts.hostname or GROUP, PORT if port is None else port
