"""What became of requests: each with its time, until the mode changes."""

import time
from dataclasses import dataclass

from limber.monitor.words import BAD, GOOD, Note

MOST = 3
AFTER_STOP = ("SOFT_STOP", "HOLD")  # the modes that a stop itself leads to


@dataclass
class _Answer:
    kind: str
    text: str
    good: bool
    clock: str
    modes: tuple[str, ...]


class Answers:
    """The newest of each kind, such as gains or STOP."""

    def __init__(self) -> None:
        self._answers: dict[str, _Answer] = {}

    def note(self, kind: str, text: str, good: bool, mode: str) -> None:
        """`mode`: in which it was answered; `text`: empty if there is nothing to tell."""
        self._answers.pop(kind, None)
        if text:
            modes = (mode, *AFTER_STOP) if kind == "STOP" else (mode,)
            self._answers[kind] = _Answer(kind, text, good, time.strftime("%H:%M:%S"), modes)

    def shown(self, mode: str) -> list[Note]:
        """The newest first; those of a mode before are gone."""
        self._answers = {k: one for k, one in self._answers.items() if mode in one.modes}
        for one in self._answers.values():
            if mode != one.modes[0]:  # it does not come back
                one.modes = one.modes[1:]
        newest = list(self._answers.values())[: -MOST - 1 : -1]
        return [
            Note(GOOD if one.good else BAD, "", f"{one.clock} {one.kind}: {one.text}")
            for one in newest
        ]
