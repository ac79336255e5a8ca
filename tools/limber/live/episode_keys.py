"""`limber log record --episodes`: a recording, and keys that mark its episodes."""

import time
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

from rich.console import Console

from limber.errors import RunError
from limber.keys import ENTER, Keys
from limber.live.episodes import KEPT, Episodes, check_task
from limber.live.receiver import Receiver
from limber.live.recording import Recording

WORDS = "s start, y success, n failure, d drop the last, k keep it after all, q end"
LOOK_S = 0.02


def record(out: Path, duration_s: float, task: str, console: Console) -> None:
    """Until q, Ctrl-C, the end of the input, or `duration_s` if it is not 0."""
    check_task(task)
    end_s = time.monotonic() + duration_s if duration_s else float("inf")
    with closing(Receiver(KEPT)) as receiver, Recording(out) as recording:
        episodes = Episodes(receiver)
        ways: dict[str, tuple[str, Callable[[], None]]] = {
            "s": ("started", lambda: episodes.start(task)),
            "y": ("success", lambda: episodes.end(True)),
            "n": ("failure", lambda: episodes.end(False)),
            "d": ("dropped", episodes.drop),
            "k": ("kept", episodes.keep),
        }
        console.print(f"recording to {out}. {WORDS}", markup=False, soft_wrap=True)
        try:
            with Keys() as person:
                while time.monotonic() < end_s and recording.running():
                    key = person.pressed()
                    if key == "q" or (key is None and person.ended):
                        break
                    if key in ways:
                        word, mark = ways[key]
                        try:
                            mark()
                            console.print(word)
                        except RunError as error:  # the recording goes on
                            console.print(str(error), style="red", markup=False, soft_wrap=True)
                    elif key not in (None, ENTER):
                        console.print(WORDS, markup=False)
                    elif key is None:
                        time.sleep(LOOK_S)
        except KeyboardInterrupt:
            console.print("ended")
        if not recording.running():
            raise RunError(f"the recording {out} has ended by itself: its disk may be full")
