"""How long the machine itself stood still: one watcher a processor, above limber's priority.

A virtual machine is paused by its host now and then; no program on it can be on time then. A
watcher does nothing but sleep for PERIOD_S again and again, and writes down when it woke up late.
"""

import json
import os
import subprocess
import sys
import time
from contextlib import AbstractContextManager, suppress
from dataclasses import dataclass
from pathlib import Path

PERIOD_S = 0.001
SHORTEST_S = 0.001  # shorter ones are not kept
PRIORITY = 90  # limber-driver has 80


@dataclass(frozen=True)
class Pause:
    """`start_s`: CLOCK_MONOTONIC."""

    processor: int
    start_s: float
    length_s: float


class Watchers(AbstractContextManager):
    """Runs them until the block ends; each writes to a file of its own in `folder`."""

    def __init__(self, folder: Path) -> None:
        self._files = {cpu: folder / f"pauses-{cpu}.jsonl" for cpu in os.sched_getaffinity(0)}
        self._children: list[subprocess.Popen] = []

    def __enter__(self) -> "Watchers":
        for cpu, path in self._files.items():
            with path.open("w", encoding="utf-8") as file:
                command = [sys.executable, "-m", __name__, str(cpu)]
                self._children.append(subprocess.Popen(command, stdout=file))
        return self

    def __exit__(self, *_error: object) -> None:
        for child in self._children:
            child.terminate()
            child.wait()

    def pauses(self) -> list[Pause]:
        """So far, in order of their start."""
        found = []
        for cpu, path in self._files.items():
            for line in path.read_text(encoding="utf-8").splitlines():
                found.append(Pause(cpu, *json.loads(line)))
        return sorted(found, key=lambda pause: pause.start_s)


def stood_still_s(pauses: list[Pause], begin_s: float, end_s: float) -> float:
    """How much of this time the processor stood still that did so for longest, s."""
    found: dict[int, float] = {}
    for pause in pauses:
        begin, end = max(pause.start_s, begin_s), min(pause.start_s + pause.length_s, end_s)
        found[pause.processor] = found.get(pause.processor, 0.0) + max(0.0, end - begin)
    return max(found.values(), default=0.0)


def _watch(processor: int) -> None:
    os.sched_setaffinity(0, {processor})
    with suppress(PermissionError):  # then a busy machine counts as a pause, too
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
    before_s = time.monotonic()
    while True:
        time.sleep(PERIOD_S)
        now_s = time.monotonic()
        length_s = now_s - before_s - PERIOD_S
        if length_s > SHORTEST_S:
            print(json.dumps([before_s + PERIOD_S, length_s]), flush=True)
        before_s = now_s


if __name__ == "__main__":
    _watch(int(sys.argv[1]))
