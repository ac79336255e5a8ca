"""Hearing the user plane while a run is going on: newest message of each channel, rates, gaps."""

import threading
import time
from collections import deque
from dataclasses import dataclass, field
from types import TracebackType
from typing import Any

import lcm
import numpy as np

from limber import messages
from limber.errors import RunError
from limber.network import CURE


@dataclass
class Heard:
    """What is known of one channel. Nothing is decoded until somebody asks."""

    data: bytes = b""
    count: int = 0
    lost: int = 0
    last_seq: int = -1
    last_s: float = 0.0
    window: deque[tuple[float, int]] = field(default_factory=lambda: deque(maxlen=64))

    def rate_hz(self) -> float:
        """Over the last seconds, from counts noted at each poll."""
        if len(self.window) < 2:
            return 0.0
        (t0, n0), (t1, n1) = self.window[0], self.window[-1]
        return (n1 - n0) / (t1 - t0) if t1 > t0 else 0.0


class Listener:
    """Subscribes to channels and drains LCM in a thread of its own. Use as a context."""

    def __init__(self, *channels: str) -> None:
        try:
            self._lcm = lcm.LCM(messages.user_plane_url())
        except RuntimeError as error:
            raise RunError(f"LCM finds no multicast route: {CURE}") from error
        self.channels = {name: Heard() for name in channels}
        for name in channels:
            self._lcm.subscribe(name, self._on_message).set_queue_capacity(0)
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._drain, daemon=True)

    def __enter__(self) -> "Listener":
        self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._stop.set()
        self._thread.join()

    def newest(self, channel: str) -> np.void | None:
        """The newest message as a numpy record, or None if there is none that fits."""
        data = self.channels[channel].data
        try:
            return messages.view(messages.channels()[channel].type_name, data) if data else None
        except ValueError:
            return None

    def _on_message(self, channel: str, data: bytes) -> None:
        heard = self.channels[channel]
        heard.data = data
        heard.count += 1
        heard.last_s = time.monotonic()
        seq = int.from_bytes(data[8:16], "big", signed=True)
        if heard.last_seq >= 0 and seq > heard.last_seq + 1:
            heard.lost += seq - heard.last_seq - 1
        heard.last_seq = seq

    def _drain(self) -> None:
        handle: Any = self._lcm.handle_timeout
        noted = 0.0
        while not self._stop.is_set():
            while handle(0) > 0:
                pass
            now = time.monotonic()
            if now - noted > 0.1:
                noted = now
                for heard in self.channels.values():
                    heard.window.append((now, heard.count))
            time.sleep(1 / 60)


def somebody_drives(wait_s: float = 0.3) -> bool:
    """True if a driver is already publishing on this machine."""
    with Listener("JOINT_STATE") as listener:
        time.sleep(wait_s)
        return listener.channels["JOINT_STATE"].count > 0
