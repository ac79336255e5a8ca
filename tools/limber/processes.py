"""Child processes that end together: started in one group, watched, and always stopped."""

import contextlib
import ctypes
import os
import signal
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType

from limber.errors import WRONG_INPUT, InputError, LimberError, RunError

_PR_SET_PDEATHSIG = 1


@dataclass
class Child:
    name: str
    process: subprocess.Popen
    log: Path
    may_end: bool = False  # it was asked to, or is the one that is waited for

    @property
    def code(self) -> int | None:
        return self.process.poll()

    def last_lines(self, count: int = 3) -> list[str]:
        text = self.log.read_text(encoding="utf-8", errors="replace").replace("\r", "\n")
        return [line for line in text.splitlines() if line.strip()][-count:]

    def failure(self) -> LimberError:
        """What the user should read about a child that ended unasked."""
        lines = self.last_lines()
        if self.code == WRONG_INPUT and lines:
            return InputError(lines[-1].removeprefix(f"{self.name}: "))
        how = f"exit code {self.code}"
        if self.code is not None and self.code < 0:
            how = f"killed by {signal.Signals(-self.code).name}"
        said = "; ".join(lines) if lines else "it said nothing"
        return RunError(f"{self.name} ended ({how}): {said} (all of it: {self.log})")


class ProcessGroup:
    """Use as a context: whatever happens inside, no child is left when it is over."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.children: dict[str, Child] = {}
        self._leader: int | None = None

    def __enter__(self) -> "ProcessGroup":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        running = [child for child in self.children.values() if child.code is None]
        for child in running:
            child.process.terminate()
        for child in running:
            if not _wait(child.process, 2.0):
                child.process.kill()
                child.process.wait()

    def start(self, name: str, command: list[str]) -> Child:
        """What the child says goes to NAME.log in the group's folder."""
        log = self.folder / f"{name}.log"
        libc = ctypes.CDLL(None)
        parent = os.getpid()

        def die_with_parent() -> None:
            libc.prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)
            if os.getppid() != parent:
                os._exit(1)

        with open(log, "wb") as said:
            process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=said,
                stderr=said,
                process_group=self._group(),
                preexec_fn=die_with_parent,
            )
        if self._leader is None:
            self._leader = process.pid
        child = self.children[name] = Child(name, process, log)
        return child

    def _group(self) -> int:
        """The first child leads; a new group when it has ended and taken its number along."""
        if self._leader is not None:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self._leader, 0)
                return self._leader
            self._leader = None
        return 0

    def wait_for_line(self, child: Child, words: str, timeout_s: float) -> None:
        """Until the child has logged `words`; not an error if it never does, only if it ends."""
        deadline = time.monotonic() + timeout_s
        while time.monotonic() < deadline:
            self.check()
            if words.encode() in child.log.read_bytes():
                return
            time.sleep(0.01)

    def check(self) -> None:
        """Raises if a child has ended with an error, or at all before its time."""
        for child in self.children.values():
            if child.code is not None and not child.may_end:
                raise child.failure()

    def stop(self, name: str, number: signal.Signals, timeout_s: float) -> int:
        """Asks a child to end, kills it if it does not; returns its exit code."""
        child = self.children[name]
        child.may_end = True
        if child.code is None:
            child.process.send_signal(number)
            if not _wait(child.process, timeout_s):
                child.process.kill()
                child.process.wait()
        return child.process.returncode

    def run_until(self, name: str, tick: Callable[[], None], interval_s: float = 0.05) -> int:
        """Waits for one child to end by itself; the others must not end before it."""
        child = self.children[name]
        child.may_end = True
        while child.code is None:
            self.check()
            tick()
            time.sleep(interval_s)
        return child.process.returncode


def _wait(process: subprocess.Popen, timeout_s: float) -> bool:
    try:
        process.wait(timeout_s)
    except subprocess.TimeoutExpired:
        return False
    return True
