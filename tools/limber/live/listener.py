"""The newest message, rate and gaps of each channel of the user plane, during a run."""

import threading
import time
from collections import deque
from contextlib import closing
from dataclasses import dataclass, field
from typing import Any

import lcm
import numpy as np

from limber import messages
from limber.errors import RunError
from limber.live.network import CURE


@dataclass
class ChannelState:
    """What is known of one channel; messages are decoded on demand."""

    data: bytes = b""
    count: int = 0
    lost: int = 0
    last_seq: int = -1
    last_s: float = 0.0
    window: deque[tuple[float, int]] = field(default_factory=lambda: deque(maxlen=64))

    def rate_hz(self) -> float:
        """Over the last seconds, from the counts in `window`."""
        if len(self.window) < 2:
            return 0.0
        (t0, n0), (t1, n1) = self.window[0], self.window[-1]
        return (n1 - n0) / (t1 - t0) if t1 > t0 else 0.0


class Listener:
    """Subscribes to channels and drains LCM in a thread of its own; close() ends the thread."""

    def __init__(self, *channels: str) -> None:
        try:
            self._lcm = lcm.LCM(messages.user_plane_url())
        except RuntimeError as error:
            raise RunError(f"LCM finds no multicast route: {CURE}") from error
        self.channels = {name: ChannelState() for name in channels}
        self._subscriptions = [self._lcm.subscribe(name, self._on_message) for name in channels]
        for subscription in self._subscriptions:
            subscription.set_queue_capacity(0)
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._drain, daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Frees the LCM instance too: while a callback refers to it, its own thread queues on."""
        self._stop.set()
        self._thread.join()
        for subscription in self._subscriptions:
            self._lcm.unsubscribe(subscription)
        self._subscriptions.clear()
        del self._lcm

    def newest(self, channel: str) -> np.void | None:
        """The newest message as a numpy record, or None if there is none that fits."""
        data = self.channels[channel].data
        try:
            return messages.view(messages.channels()[channel].type_name, data) if data else None
        except ValueError:
            return None

    def _on_message(self, channel: str, data: bytes) -> None:
        state = self.channels[channel]
        state.data = data
        state.count += 1
        state.last_s = time.monotonic()
        seq = int.from_bytes(data[8:16], "big", signed=True)
        if state.last_seq >= 0 and seq > state.last_seq + 1:
            state.lost += seq - state.last_seq - 1
        state.last_seq = seq

    def _drain(self) -> None:
        handle: Any = self._lcm.handle_timeout
        noted = 0.0
        while not self._stop.is_set():
            while handle(0) > 0:
                pass
            now = time.monotonic()
            if now - noted > 0.1:
                noted = now
                for state in self.channels.values():
                    state.window.append((now, state.count))
            time.sleep(1 / 60)


def driver_is_running(wait_s: float = 0.3) -> bool:
    """True if a driver is publishing on this machine."""
    with closing(Listener("JOINT_STATE")) as listener:
        time.sleep(wait_s)
        return listener.channels["JOINT_STATE"].count > 0
