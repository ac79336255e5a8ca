"""A plain LCM event log, as lcm-logger writes it: whole events, byte for byte."""

from collections.abc import Sequence
from pathlib import Path

from limber.log.reader import Log


class LcmFile:
    def __init__(self, path: Path, _joints: tuple[str, ...]) -> None:
        self._file = open(path, "wb")  # noqa: SIM115

    def copy(self, log: Log, channels: Sequence[str]) -> None:
        for data in log.event_bytes(channels):
            self._file.write(data)

    def close(self) -> None:
        self._file.close()
