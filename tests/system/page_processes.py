"""The processes of a browser that a test started, to stop some of them."""

import os
import signal
from contextlib import contextmanager, suppress
from pathlib import Path


def _children() -> dict[int, list[int]]:
    found: dict[int, list[int]] = {}
    for entry in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            parent = int((entry / "stat").read_text().rsplit(")", 1)[1].split()[1])
            found.setdefault(parent, []).append(int(entry.name))
    return found


def _command(process: int) -> str:
    with suppress(OSError):
        return Path(f"/proc/{process}/cmdline").read_bytes().replace(b"\0", b" ").decode()
    return ""


def browsers(kind: str) -> list[int]:
    """Of all browsers below this process: `browser`, the process with the window, `renderer`, the
    ones with pages, or `all`.
    """
    children, found, waiting = _children(), [], [os.getpid()]
    while waiting:
        process = waiting.pop()
        waiting += children.get(process, [])
        command = _command(process)
        if "chromium" not in command or "playwright" in command.split(" ")[0]:
            continue
        own = {"browser": "--type=" not in command and "crashpad" not in command}
        own["renderer"] = "--type=renderer" in command
        if own.get(kind, True):
            found.append(process)
    return found


@contextmanager
def stopped(kind: str):
    """Stopped as by Ctrl-Z; at the end all go on."""
    processes = browsers(kind)
    assert processes, f"no {kind} process of a browser below this one"
    try:
        for process in processes:
            os.kill(process, signal.SIGSTOP)
        yield
    finally:
        for process in processes:
            with suppress(ProcessLookupError):
                os.kill(process, signal.SIGCONT)
