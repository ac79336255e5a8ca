"""One numpy file: CHANNEL.field -> array, one row a message, as the fields are in lcmtypes/."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from limber.log.convert.csv_files import STAMP
from limber.log.convert.windows import Batch
from limber.log.events import Event
from limber.messages import FINGERPRINT


class NpzFile:
    """The format has no pieces: everything is in memory until close()."""

    def __init__(self, path: Path, joints: tuple[str, ...]) -> None:
        self._path = path
        self._parts: dict[str, list[np.ndarray]] = {}

    def begin(self, story: Sequence[Event], arm_time_zero_us: int) -> None:
        """Text has no place here."""

    def write(self, window: list[Batch]) -> None:
        for batch in window:
            assert isinstance(batch.messages, np.ndarray)
            self._add(f"{batch.channel}.{STAMP}", batch.stamps_us)
            for field in batch.messages.dtype.names or ():
                if field != FINGERPRINT:
                    self._add(f"{batch.channel}.{field}", batch.messages[field])

    def close(self) -> None:
        arrays: dict[str, Any] = {name: np.concatenate(p) for name, p in self._parts.items()}
        with open(self._path, "wb") as file:
            np.savez_compressed(file, **arrays)

    def _add(self, name: str, values: np.ndarray) -> None:
        self._parts.setdefault(name, []).append(values)
