"""One LCM plane for one process, in LCM's wire format, without its library."""

import socket
import struct
from collections.abc import Callable, Iterator
from itertools import count
from urllib.parse import parse_qs, urlsplit

from limber.errors import RunError
from limber.live.network import CURE
from limber.live.plane_receiver import PlaneReceiver

GROUP, PORT = "239.255.76.67", 7667  # LCM's own
LONGEST_SHORT, LONGEST_PART = 65_499, 65_487  # liblcm's, of what follows the header

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
        """In one datagram, or in fragments, as LCM sends it. RunError without a multicast route."""
        if self._sender is None:
            self._sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            self._sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, self._ttl)
        try:
            for datagram in datagrams(next(self._numbers) % 2**32, channel, data):
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


def datagrams(number: int, channel: str, data: bytes) -> Iterator[bytes]:
    """Of a message: "LC02", number, channel, 0, message; of one that is too long for this "LC03"
    with a part each, as common/lcm_fragments.h has it.
    """
    name = channel.encode("ascii") + b"\0"
    if len(name) + len(data) <= LONGEST_SHORT:
        yield struct.pack(">4sI", b"LC02", number) + name + data
        return
    count = -(-(len(name) + len(data)) // LONGEST_PART)
    at = 0
    for i in range(count):
        head = struct.pack(">4sIIIHH", b"LC03", number, len(data), at, i, count)
        part = data[at : at + LONGEST_PART - len(name)]
        yield head + name + part
        at, name = at + len(part), b""


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
