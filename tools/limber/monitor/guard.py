"""A fault in one part of the page does not take the others with it, STOP least of all."""

import os
import traceback
from collections.abc import Callable
from typing import Any

from rich.console import Console


class Guard:
    """Calls the parts. `faults`: what went wrong, each once; also on the console, with its place.
    LIMBER_DEBUG=1 ends the program instead.
    """

    def __init__(self, console: Console) -> None:
        self._console = console
        self.faults: list[str] = []

    def __call__(self, part: Callable[..., Any], *arguments: Any) -> None:
        try:
            part(*arguments)
        except Exception as error:
            if os.environ.get("LIMBER_DEBUG") == "1":
                raise
            fault = f"{type(error).__name__}: {' '.join(str(error).split())}"
            if fault not in self.faults:
                self.faults.append(fault)
                trace = traceback.format_exc()
                self._console.print(trace, style="red", markup=False, soft_wrap=True)
