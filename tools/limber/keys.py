"""What the person at the terminal wants: single keys, or lines where there is no terminal."""

import os
import select
import sys
import termios
import tty
from typing import Self

ENTER = "\n"


class Keys:
    """Context manager. `single`: keys count at once; else a line each, of which the first letter
    counts, and those not read yet are the next one's. Ctrl-C interrupts as ever.
    """

    _left = ""  # lines without a terminal

    def __init__(self) -> None:
        self.single = sys.stdin is not None and sys.stdin.isatty()
        self.ended = sys.stdin is None  # nobody can answer
        self._waiting = ""
        self._before: list | None = None

    def __enter__(self) -> Self:
        if self.single:
            self._before = termios.tcgetattr(sys.stdin)
            tty.setcbreak(sys.stdin)
        else:
            self._waiting, Keys._left = Keys._left, ""
        return self

    def __exit__(self, *_error: object) -> None:
        if self._before is not None:
            termios.tcsetattr(sys.stdin, termios.TCSADRAIN, self._before)
        else:
            Keys._left = self._waiting

    def pressed(self) -> str | None:
        """The next key, in small letters, ENTER for none; None if there was none."""
        self._read()
        if self.single and self._waiting:
            key, self._waiting = self._waiting[0], self._waiting[1:]
            return key.lower().replace("\r", ENTER)
        line, newline, rest = self._waiting.partition("\n")
        if self.single or not newline:
            return None
        self._waiting = rest
        return line.strip()[:1].lower() or ENTER

    def forget(self) -> None:
        """What was pressed before now is no answer to what is asked next."""
        self._read()
        if self.single:
            self._waiting = ""

    def _read(self) -> None:
        while not self.ended and select.select([sys.stdin], [], [], 0.0)[0]:
            data = os.read(sys.stdin.fileno(), 4096)
            self.ended = not data
            self._waiting += data.decode(errors="replace")
