"""Marks of episodes in what is being recorded: from a script, a page or a terminal."""

import threading
import time

from limber import messages
from limber.errors import InputError, RunError
from limber.live.receiver import Receiver

CHANNEL, KEPT = "EPISODE", "EPISODE_KEPT"
MARK = messages.message_class("episode_mark_t")
AGAIN_S, KEPT_S = 0.2, 10.0  # a mark that is not kept is sent again; so long: a disk may be busy


def check_task(task: str) -> None:
    if not task.isprintable() or len(task.encode()) > MARK.LONGEST_TASK:
        raise InputError(f"task: expected one line of at most {MARK.LONGEST_TASK} bytes")


class Episodes:
    """Marks the log of every limber-record (`limber log record`, `Arm.record`) on this machine.

    Each call returns when a recorder has its mark in the log's file. RunError if none has.
    """

    def __init__(self, receiver: Receiver) -> None:
        self._receiver = receiver
        self._kept = receiver.stream(KEPT)
        self._turn = threading.Lock()
        self._seq = 0

    def start(self, task: str = "") -> None:
        """An episode begins; one that has not ended ends without success or failure."""
        check_task(task)
        self._mark(MARK.MARK_START, task)

    def end(self, success: bool) -> None:
        """The newest episode ends here, or has another outcome if it has ended."""
        self._mark(MARK.MARK_SUCCESS if success else MARK.MARK_FAILURE)

    def drop(self) -> None:
        """The newest episode is left out of what is made of the log, in which it stays."""
        self._mark(MARK.MARK_DROP)

    def keep(self) -> None:
        """Takes drop() back."""
        self._mark(MARK.MARK_KEEP)

    def _mark(self, kind: int, task: str = "") -> None:
        with self._turn:
            self._kept.raw()
            self._seq = max(self._seq + 1, time.monotonic_ns())
            mark = MARK()
            mark.seq = mark.time_ns = self._seq
            mark.mark, mark.task = kind, task
            end_s = time.monotonic() + KEPT_S
            while time.monotonic() < end_s:
                self._receiver.publish(CHANNEL, mark)
                if self._is_kept(mark.encode()):
                    return
        raise RunError(
            f"no limber-record has kept the mark within {KEPT_S:g} s: start "
            "limber log record --episodes, or arm.record()"
        )

    def _is_kept(self, mark: bytes) -> bool:
        end_s = time.monotonic() + AGAIN_S
        while (left_s := end_s - time.monotonic()) > 0 and self._kept.wait(left_s):
            if mark in self._kept.raw():
                return True
        return False
