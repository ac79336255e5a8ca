"""One LCM plane for one process, in LCM's wire format, without its library."""

import socket
import struct
from collections.abc import Callable
from itertools import count
from urllib.parse import parse_qs, urlsplit

from limber.errors import RunError
from limber.live.network import CURE
from limber.live.plane_receiver import PlaneReceiver

GROUP, PORT = "239.255.76.67", 7667  # LCM's own

Handler = Callable[[str, bytes], None]


class Line:
    """`url`: udpm://[GROUP[:PORT]]?ttl=0. For one thread, publish() apart, which any may call.

    Hears nothing before the first subscribe(). RunError at another address.
    """

    def __init__(self, url: str) -> None:
        self._group, self._port, self._ttl = _place(url)
        self._sender: socket.socket | None = None
        self._numbers = count()
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
        """One datagram of LCM's: magic, number, channel, 0, message. Raises RunError without a
        multicast route, or for more than a datagram holds.
        """
        if self._sender is None:
            self._sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            self._sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, self._ttl)
        header = struct.pack(">4sI", b"LC02", next(self._numbers) % 2**32)
        datagram = header + channel.encode("ascii") + b"\0" + data
        try:
            self._sender.sendto(datagram, (self._group, self._port))
        except OSError as error:
            raise RunError(f"{channel} cannot be sent ({error.strerror}): {CURE}") from error

    def close(self) -> None:
        """Nothing more is heard."""
        self._handlers.clear()
        if self._receiver is not None:
            self._receiver.close()
            self._receiver = None
        if self._sender is not None:
            self._sender.close()
            self._sender = None


def _place(url: str) -> tuple[str, int, int]:
    """Group, port, and how many routers a datagram passes: none, if nothing is written."""
    parts = urlsplit(url)
    try:
        port, ttl = parts.port, int(parse_qs(parts.query).get("ttl", ["0"])[0])
    except ValueError:
        port, ttl = 0, 0
    if parts.scheme != "udpm" or port == 0 or not 0 <= ttl <= 255:
        raise RunError(f"LCM address {url}: expected udpm://GROUP:PORT?ttl=0")
    return parts.hostname or GROUP, PORT if port is None else port, ttl
