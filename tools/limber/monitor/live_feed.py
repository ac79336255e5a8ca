"""Messages of the running stack, for the page."""

from typing import Any

import numpy as np

from limber import messages
from limber.live.receiver import Receiver
from limber.monitor.feed import NUMERIC, WITH_STRINGS, Batch


class LiveFeed:
    """Every message of the user plane that the page needs; close() ends the receiver's thread."""

    def __init__(self) -> None:
        self.receiver = Receiver(*NUMERIC, *WITH_STRINGS)
        self.newest: dict[str, np.void] = {}
        self._streams = {name: self.receiver.stream(name) for name in self.receiver.channels}

    def take(self) -> Batch:
        batch = Batch()
        for channel in NUMERIC:
            rows = self._streams[channel].read()
            if len(rows):
                batch.arrays[channel] = rows
                self.newest[channel] = rows[-1]
        for channel in WITH_STRINGS:
            if self._streams[channel].waiting():
                batch.objects[channel] = self._decode(channel)
        return batch

    def age_s(self, channel: str) -> float:
        return self.receiver.channels[channel].age_s()

    def troubles(self) -> list[str]:
        states = self.receiver.channels.items()
        unreadable = [
            f"{state.undecodable} messages on {channel} are no such message, or of another version "
            "of limber"
            for channel, state in states
            if state.undecodable
        ]
        lost = [f"{state.lost} of {channel}" for channel, state in states if state.lost]
        if not lost:
            return unreadable
        words = f"Lost on the way to this page: {', '.join(lost)}. limber doctor names what helps."
        return [*unreadable, words]

    def received(self) -> str:
        """What came in all, in a sentence."""
        states = self.receiver.channels.values()
        count, lost = sum(state.count for state in states), sum(state.lost for state in states)
        return f"{count} messages received, {lost} lost"

    def close(self) -> None:
        self.receiver.close()

    def _decode(self, channel: str) -> list[Any]:
        """What is garbled behind a good beginning is left out and counted."""
        state, decoded = self.receiver.channels[channel], []
        for data in self._streams[channel].raw():
            try:
                decoded.append(messages.decode(state.type_name, data))
            except ValueError:
                state.undecodable += 1
        return decoded
