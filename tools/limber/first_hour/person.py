"""Questions to the person beside the arm."""

import time

from rich.console import Console

from limber.errors import InputError
from limber.keys import ENTER, Keys

PERIOD_S = 0.05


def answer(console: Console, question: str, keys: str = "") -> str:
    """ENTER or one of `keys`, each a letter. Raises KeyboardInterrupt on q, InputError without
    anybody to answer.
    """
    console.print(f"{question} ", end="", markup=False, highlight=False, soft_wrap=True)
    with Keys() as person:
        person.forget()
        while True:
            key = person.pressed()
            if key == "q":
                console.print()
                raise KeyboardInterrupt
            if key == ENTER or (key and key in keys):
                console.print()
                return key
            if key is None and person.ended:
                raise InputError("a person at the terminal has to answer")
            time.sleep(PERIOD_S)
