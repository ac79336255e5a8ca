"""What is heard before a replay, where the machine pauses."""

import time
from collections.abc import Callable

import pytest

from limber.errors import RunError
from limber.replay.silence import require_silence

URL = "udpm://239.255.76.67:7667?ttl=0"


class PausedLine:
    """A line on which the first message comes in the `window`th window; the first takes a second,
    as where the machine stands still meanwhile, with all who send.
    """

    def __init__(self, window: int) -> None:
        self._window = window
        self._pause_s = 1.0
        self._handlers: dict[str, Callable[[str, bytes], None]] = {}

    def subscribe(self, channel: str, handler: Callable[[str, bytes], None]) -> str:
        self._handlers[channel] = handler
        return channel

    def unsubscribe(self, channel: str) -> None:
        del self._handlers[channel]

    def handle_timeout(self, _timeout_ms: int) -> int:
        self._window -= 1
        if self._window == 0:
            self._handlers["ROBOT_INFO"]("ROBOT_INFO", b"")
            return 1
        time.sleep(self._pause_s)
        self._pause_s = 0.0
        return 0


def test_a_stack_is_heard_after_a_pause_of_the_machine():
    with pytest.raises(RunError, match="ROBOT_INFO is heard on udpm"):
        require_silence(PausedLine(window=5), URL)


def test_silence_is_silence():
    line = PausedLine(window=100)
    require_silence(line, URL)
    assert not line._handlers, "nothing is subscribed any more"
