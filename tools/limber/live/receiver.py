"""Messages of the user plane as they arrive: the newest of each channel, and all of a channel.

A thread without Python's lock empties the socket (tools/receiver), so that a busy script loses
nothing; one of Python's takes what has come and only checks, counts and keeps the bytes. Decoding
waits until somebody reads, and then numpy views all that has come as one array.
"""

import struct
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from contextlib import closing
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from limber import messages
from limber.live.line import Line
from limber.messages import SENDERS


class Stream:
    """Every message of a channel since it was opened, until close(); what is not read is kept."""

    def __init__(self, channel: "ChannelState", news: threading.Condition) -> None:
        self._channel = channel
        self._parts: list[bytes] = []
        self._news = news
        self.keep = self._parts.append
        channel.streams.append(self)

    def raw(self) -> list[bytes]:
        """The bytes of the messages that came since the last call."""
        found = self._parts[:]
        del self._parts[: len(found)]  # what has come meanwhile stays
        return found

    def read(self) -> np.ndarray:
        """The messages that came since the last call, as records in the machine's byte order."""
        return messages.views(self._channel.type_name, self.raw())

    def wait(self, timeout_s: float) -> bool:
        """Until there is something to read; False if there is nothing after `timeout_s`."""
        with self._news:
            return self._news.wait_for(self.waiting, timeout_s)

    def waiting(self) -> bool:
        """There is something to read."""
        return bool(self._parts)

    def close(self) -> None:
        """Nothing more is kept."""
        if self in self._channel.streams:
            self._channel.streams.remove(self)


@dataclass
class ChannelState:
    """One channel: its newest message and what was counted.

    `lost`: missing numbers of the field `seq`, counted for each run of each sender (JOINT_TORQUE
    has none: it carries that of the state it answers); `undecodable`: of another type or version.
    """

    type_name: str
    numbered: bool = True
    data: bytes = b""
    count: int = 0
    lost: int = 0
    undecodable: int = 0
    last_s: float = 0.0  # monotonic clock
    window: deque[tuple[float, int]] = field(default_factory=lambda: deque(maxlen=64))
    streams: list[Stream] = field(default_factory=list)

    def __post_init__(self) -> None:
        wire = messages.dtype_of(self.type_name)
        self._fingerprint = messages.fingerprint_of(self.type_name).to_bytes(8, "big")
        self._counts = self.numbered and wire is not None and "seq" in (wire.fields or {})
        self._head = _head_of(wire, self._counts)
        self._next_seq: dict[int | bytes, int] = {}  # of each sender

    def take(self, data: bytes) -> None:
        """A message has come."""
        try:
            fingerprint, seq, sender = self._head(data)
        except struct.error:
            fingerprint = b""
        if fingerprint != self._fingerprint:
            self.undecodable += 1
            return
        if self._counts:
            missing = seq - self._next_seq.get(sender, seq)
            if missing > 0:
                self.lost += missing
            self._next_seq[sender] = seq + 1
        for stream in self.streams:
            stream.keep(data)
        self.data = data
        self.count += 1
        self.last_s = time.monotonic()

    def rate_hz(self) -> float:
        """Over the last seconds, from the counts in `window`."""
        if len(self.window) < 2:
            return 0.0
        (t0, n0), (t1, n1) = self.window[0], self.window[-1]
        return (n1 - n0) / (t1 - t0) if t1 > t0 else 0.0

    def age_s(self) -> float:
        """Time since the newest message; infinite if there was none."""
        return time.monotonic() - self.last_s if self.count else float("inf")


def _head_of(wire: np.dtype | None, counts: bool) -> Callable[[bytes], tuple[Any, ...]]:
    """Reads fingerprint, seq and the run of the sender of a message, the latter two if they count
    and are there, else empty bytes; struct.error if its size is another.
    """
    if wire is None:
        return struct.Struct(">8s0s0s").unpack_from
    head = ">8s0s0s"
    if counts:  # seq is the first field
        fields: Mapping[str, tuple[Any, ...]] = wire.fields or {}
        sender_at = next((fields[name][1] for name in SENDERS if name in fields), None)
        head = ">8sq0s" if sender_at is None else f">8sq{sender_at - 16}xq"
    return struct.Struct(f"{head}{wire.itemsize - struct.calcsize(head)}x").unpack


class Receiver:
    """Subscribes to channels and receives in a thread of its own; close() ends it.

    `interval_s`: what has arrived is taken over this often, at most. Short: newer values; long:
    less load. `url`: LCM address, by default that of this machine's stack. Raises RunError if the
    machine has no multicast route.
    """

    def __init__(self, *channels: str, interval_s: float = 1 / 60, url: str | None = None) -> None:
        self._line = Line(url or messages.user_plane_url())
        table = messages.channels()
        self.channels = {
            name: ChannelState(table[name].type_name, table[name].numbered) for name in channels
        }
        self._interval_s = interval_s
        self._news = threading.Condition()
        for name in channels:
            self._line.subscribe(name, self._take)
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._receive, name="limber receiver", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Nothing more is received."""
        if self._stop.is_set():
            return
        self._stop.set()
        self._thread.join()
        self._line.close()

    def newest(self, channel: str) -> np.void | None:
        """The newest message as a numpy record, or None if there is none."""
        state = self.channels[channel]
        return messages.view(state.type_name, state.data) if state.data else None

    def stream(self, channel: str) -> Stream:
        """All messages of a channel from now on."""
        return Stream(self.channels[channel], self._news)

    def wait_for(self, condition: Callable[[], bool], timeout_s: float) -> bool:
        """Until `condition` holds, which is tried when messages have come; False: it did not."""
        with self._news:
            return self._news.wait_for(condition, timeout_s)

    def publish(self, channel: str, message: Any) -> None:
        """Sends a message; from any thread."""
        self._line.publish(channel, message.encode())

    def _take(self, channel: str, data: bytes) -> None:
        self.channels[channel].take(data)

    def _receive(self) -> None:
        noted_s = 0.0
        while not self._stop.is_set():
            self._line.handle_timeout(100)
            now_s = time.monotonic()
            if now_s - noted_s > 0.1:
                noted_s = now_s
                for state in self.channels.values():
                    state.window.append((now_s, state.count))
            with self._news:
                self._news.notify_all()
            self._stop.wait(self._interval_s)


def driver_is_running(wait_s: float = 0.3) -> bool:
    """True if a driver is publishing on this machine."""
    with closing(Receiver("JOINT_STATE")) as receiver:
        state = receiver.channels["JOINT_STATE"]
        return receiver.wait_for(lambda: state.count > 0, wait_s)
