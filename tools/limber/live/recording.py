"""A recording by limber-record, which stamps messages as they arrive and drops none."""

import json
import os
import signal
import subprocess
import tempfile
import time
import warnings
from pathlib import Path
from typing import Any

from limber.errors import RunError
from limber.paths import output_folder, program

STARTS_S = 5.0
TAIL_S = 0.2  # the stack goes on, so its messages never end


class Recording:
    """Records until the end of the block. `path`: the log; `lost`: messages by channel that never
    arrived, known at the end.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.lost: dict[str, int] = {}

    def __enter__(self) -> "Recording":
        output_folder(self.path.parent)
        self._notes = tempfile.TemporaryFile()
        command = [str(program("limber-record")), "--out", str(self.path), "--tail", str(TAIL_S)]
        self._process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=self._notes,
            encoding="utf-8",
            errors="replace",
            start_new_session=True,  # Ctrl-C ends the script, and the script the recording
        )
        end_s = time.monotonic() + STARTS_S
        while "recording" not in self._told():
            if self._process.poll() is not None or time.monotonic() > end_s:
                self._process.kill()
                raise RunError(f"limber-record does not start: {self._told().strip()}")
            time.sleep(0.01)
        return self

    def running(self) -> bool:
        """It has not ended by itself, as it does when the disk is full."""
        return self._process.poll() is None

    def __exit__(self, *_error: object) -> None:
        self._process.send_signal(signal.SIGINT)
        report, _ = self._process.communicate(timeout=20)
        if self._process.returncode != 0:
            raise RunError(f"the recording {self.path} failed: {self._told().strip()}")
        found: dict[str, Any] = json.loads(report.splitlines()[-1])
        # JOINT_TORQUE is numbered by the state it answers: a gap is a cycle without an answer.
        lost = {name: count for name, count in found["lost"].items() if name != "JOINT_TORQUE"}
        self.lost = {name: count for name, count in lost.items() if count}
        self._notes.close()
        shown = ", ".join(f"{count} of {name}" for name, count in self.lost.items())
        more = found["dropped"] - sum(self.lost.values())
        if more > 0:
            shown += f"{', ' if shown else ''}{more} more before the recorder"
        if shown:
            warnings.warn(f"{self.path}: messages lost: {shown}", stacklevel=2)

    def _told(self) -> str:
        # At a place of its own: the recorder writes where the file's position is.
        return os.pread(self._notes.fileno(), 1 << 16, 0).decode(errors="replace")
