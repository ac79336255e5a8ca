"""Child processes that end together: started in one group, watched, and always stopped."""

import ctypes
import os
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path

from limber.errors import WRONG_INPUT, InputError, LimberError, RunError
from limber.output import new_file

_PR_SET_PDEATHSIG = 1
_MARKS = (": warning: ", ": error: ")  # as the programs write them


@dataclass
class Child:
    name: str
    process: subprocess.Popen
    log: Path
    read: int = 0  # bytes of the log that news() has seen
    told: set[str] = field(default_factory=set)  # lines that news() has returned
    may_end: bool = False  # it was signalled to end, or its end is awaited
    spared: bool = False  # once all have started, the others go on without it

    @property
    def code(self) -> int | None:
        return self.process.poll()

    def last_lines(self, count: int = 3) -> list[str]:
        text = self.log.read_text(encoding="utf-8", errors="replace").replace("\r", "\n")
        return [line for line in text.splitlines() if line.strip()][-count:]

    def news(self) -> list[str]:
        """What it has logged since the last call that nobody may overlook, without time and name;
        each line once in a run.
        """
        with open(self.log, "rb") as log:
            log.seek(self.read)
            whole, end, _ = log.read().rpartition(b"\n")  # the last line may not be complete yet
        self.read += len(whole + end)
        lines = whole.decode("utf-8", errors="replace").splitlines()
        told = [line.partition(mark)[2] for line in lines for mark in _MARKS if mark in line]
        new = [line for line in dict.fromkeys(told) if line not in self.told]
        self.told.update(new)
        return new

    def failure(self) -> LimberError:
        """The error to report for a child that ended unexpectedly."""
        lines = self.last_lines()
        if self.code == WRONG_INPUT and lines:
            return InputError(lines[-1].removeprefix(f"{self.name}: "))
        how = f"exit code {self.code}"
        if self.code is not None and self.code < 0:
            how = f"killed by {signal.Signals(-self.code).name}"
        output = "; ".join(lines) if lines else "no output"
        return RunError(f"{self.name} ended ({how}): {output} (all of it: {self.log})")


class ProcessGroup:
    """Children in one process group; `process_group` stops them at the end of a block."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.children: dict[str, Child] = {}
        self._leader: int | None = None

    def stop_all(self) -> None:
        running = [child for child in self.children.values() if child.code is None]
        for child in running:
            child.process.terminate()
        for child in running:
            _wait_or_kill(child.process, 2.0)

    def start(self, name: str, command: list[str], spared: bool = False) -> Child:
        """The output of the child goes to NAME.log in the group's folder."""
        log = self.folder / f"{name}.log"
        libc = ctypes.CDLL(None)
        parent = os.getpid()

        def die_with_parent() -> None:
            libc.prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)
            if os.getppid() != parent:
                os._exit(1)

        with new_file(log, "wb") as output:
            process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=output,
                process_group=self._group(),
                preexec_fn=die_with_parent,
            )
        if self._leader is None:
            self._leader = process.pid
        child = self.children[name] = Child(name, process, log, spared=spared)
        return child

    def _group(self) -> int:
        """The group of the first child; a new one (0) when no process of that group is left."""
        if self._leader is not None:
            with suppress(ProcessLookupError):
                os.killpg(self._leader, 0)
                return self._leader
            self._leader = None
        return 0

    def wait_for_line(self, child: Child, words: str, timeout_s: float) -> None:
        """Waits until the child has logged `words`; at the timeout it just returns."""
        deadline = time.monotonic() + timeout_s
        while time.monotonic() < deadline:
            self.check()
            if words.encode() in child.log.read_bytes():
                return
            time.sleep(0.01)

    def check(self, started: bool = False) -> None:
        """Raises if a child has ended that was not expected to; `started`: all have started."""
        for child in self.children.values():
            ended = child.code is not None and not child.may_end
            if ended and not (started and child.spared):
                raise child.failure()

    def missed(self) -> list[Child]:
        """The spared children that have ended since the last call."""
        ended = [c for c in self.children.values() if c.spared and not c.may_end]
        ended = [child for child in ended if child.code is not None]
        for child in ended:
            child.may_end = True
        return ended

    def stop(self, name: str, number: signal.Signals, timeout_s: float) -> int:
        """Sends a signal to a child, kills it after the timeout; returns its exit code."""
        child = self.children[name]
        child.may_end = True
        if child.code is None:
            child.process.send_signal(number)
            _wait_or_kill(child.process, timeout_s)
        return child.process.returncode

    def run_until(self, name: str, tick: Callable[[], None], interval_s: float = 0.05) -> int:
        """Waits for one child to end by itself; raises if one that is not spared ends before it."""
        child = self.children[name]
        child.may_end = True
        while child.code is None:
            self.check(started=True)
            tick()
            with suppress(subprocess.TimeoutExpired):
                child.process.wait(interval_s)
        return child.process.returncode


@contextmanager
def process_group(folder: Path) -> Iterator[ProcessGroup]:
    """No child is left when the block ends, whatever happens inside."""
    group = ProcessGroup(folder)
    try:
        yield group
    finally:
        group.stop_all()


@contextmanager
def sigterm_as_interrupt() -> Iterator[None]:
    """`kill` ends a run as Ctrl-C does: the arm first, the log last."""

    def interrupt(_number: int, _frame: object) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _wait_or_kill(process: subprocess.Popen, timeout_s: float) -> None:
    try:
        process.wait(timeout_s)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
