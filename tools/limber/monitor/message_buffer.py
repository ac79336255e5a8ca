"""viser's buffer of messages, filled by one thread and sent by another.

viser 1.1 sets an asyncio.Event from the thread that draws, which asyncio forbids: while a viewer
begins to wait, it ends with "deque mutated during iteration" and the rest of that drawing is lost.
viser sets the event once more in its event loop, which is enough to wake whoever waits.
"""

import asyncio
from dataclasses import dataclass

import viser.infra._infra as infra
from viser.infra._async_message_buffer import AsyncMessageBuffer


class LoopEvent(asyncio.Event):
    """`set` is allowed in any thread; waiters wake by the `set` that runs in `loop`."""

    _value: bool

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        super().__init__()
        self._own_loop = loop

    def set(self) -> None:
        if asyncio._get_running_loop() is self._own_loop:
            self._value = False  # or asyncio takes it that everybody is awake
            super().set()
        else:
            self._value = True


@dataclass
class Buffer(AsyncMessageBuffer):
    def __post_init__(self) -> None:
        self.message_event = LoopEvent(self.event_loop)


def use_own_buffer() -> None:
    """For servers and viewers from now on."""
    infra.AsyncMessageBuffer = Buffer  # type: ignore[misc]
