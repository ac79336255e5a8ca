"""One CSV file a channel, one row a message."""

import csv
import json
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any, TextIO

import numpy as np

from limber.log.convert.columns import as_object, columns
from limber.log.convert.windows import Batch
from limber.log.events import Event

STAMP = "log_time_us"  # when the message was recorded


class CsvFiles:
    def __init__(self, path: Path, joints: tuple[str, ...]) -> None:
        path.mkdir()
        self._folder, self._joints = path, joints
        self._files: dict[str, TextIO] = {}
        self._open = ExitStack()

    def begin(self, story: Sequence[Event], arm_time_zero_us: int) -> None:
        rows = [(f"{event.time_s:.6f}", event.who, event.text, int(event.bad)) for event in story]
        self._rows("events", ["time_s", "who", "what", "bad"], rows)

    def write(self, window: list[Batch]) -> None:
        for batch in window:
            table = flat(batch, self._joints)
            values = (_plain(column) for column in table.values())
            self._rows(batch.channel, list(table), zip(*values, strict=True))

    def close(self) -> None:
        self._open.close()

    def _rows(self, name: str, header: list[str], rows: Any) -> None:
        if name not in self._files:
            path = self._folder / f"{name}.csv"
            file = open(path, "w", newline="", encoding="utf-8")  # noqa: SIM115
            self._files[name] = self._open.enter_context(file)
            csv.writer(self._files[name]).writerow(header)
        csv.writer(self._files[name]).writerows(rows)


def flat(batch: Batch, joints: tuple[str, ...]) -> dict[str, Any]:
    """Column name -> its values. Lists of any length are JSON text."""
    made: dict[str, Any] = {STAMP: batch.stamps_us}
    if isinstance(batch.messages, np.ndarray):
        for column in columns(batch.type_name, joints):
            place: tuple[slice | int, ...] = (slice(None), *column.index)
            made[column.name] = batch.messages[column.field][place]
        return made
    rows = [dict(_leaves(as_object(message, joints))) for message in batch.messages]
    return made | {name: [row[name] for row in rows] for name in rows[0]}


def _leaves(values: dict[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in values.items():
        if isinstance(value, dict):
            yield from _leaves(value, f"{before}{name}.")
        else:
            yield before + name, json.dumps(value) if isinstance(value, list) else value


def _plain(column: Any) -> list[Any]:
    values: list[Any] = column.tolist() if isinstance(column, np.ndarray) else column
    return values
