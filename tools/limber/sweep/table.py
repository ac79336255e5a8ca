"""The rows of a sweep as Parquet: pieces while they come, one table in the end.

A piece is replaced as a whole until it is full, so that a kill leaves every row that was added and
no half of one.
"""

import shutil
from pathlib import Path
from typing import Any

import pyarrow
from pyarrow import parquet

from limber.errors import InputError
from limber.log.results import written_whole
from limber.sweep.variation import Variation

WHOLE, PIECES = "runs.parquet", "runs"
PIECE = 256  # rows
TEXT = ("outcome", "fault", "reason")
NUMBERS = ("overshoot", "stiffness_error", "settling_s", "peak_torque_of_limit")


class Table:
    """`done`: numbers of the runs that are in it."""

    def __init__(self, folder: Path, vary: tuple[Variation, ...]) -> None:
        self._whole, self._pieces = folder / WHOLE, folder / PIECES
        kinds = {"run": pyarrow.int64(), "seed": pyarrow.int64()}
        kinds |= {variation.key: _kind(variation) for variation in vary}
        kinds |= dict.fromkeys(TEXT, pyarrow.string()) | dict.fromkeys(NUMBERS, pyarrow.float64())
        self._schema = pyarrow.schema(list(kinds.items()))
        files = sorted(self._pieces.glob("piece-*.parquet"))
        self._number = int(files[-1].stem.removeprefix("piece-")) + 1 if files else 0
        self._piece: list[dict[str, Any]] = []  # rows of the newest
        kept = [self._whole] if self._whole.exists() else files
        self._kept = pyarrow.concat_tables([self._schema.empty_table(), *map(self._read, kept)])
        self.done: set[int] = set(self._kept["run"].to_pylist())

    def add(self, rows: list[dict[str, Any]]) -> None:
        """Those of runs that are not in it yet; they are on the disk afterwards."""
        self._piece += [row for row in rows if row["run"] not in self.done]
        self.done |= {row["run"] for row in rows}
        self._pieces.mkdir(exist_ok=True)
        part = pyarrow.Table.from_pylist(self._piece, self._schema)
        self._write(part, self._pieces / f"piece-{self._number:05}.parquet")
        if len(self._piece) >= PIECE:
            self._kept = pyarrow.concat_tables([self._kept, part])
            self._number, self._piece = self._number + 1, []

    def rows(self) -> pyarrow.Table:
        """By their numbers."""
        last = pyarrow.Table.from_pylist(self._piece, self._schema)
        return pyarrow.concat_tables([self._kept, last]).combine_chunks().sort_by("run")

    def finish(self) -> None:
        """One file with all rows instead of the pieces."""
        self._write(self.rows(), self._whole)
        shutil.rmtree(self._pieces, ignore_errors=True)

    def _write(self, table: pyarrow.Table, file: Path) -> None:
        with written_whole(file) as part:
            parquet.write_table(table, part, compression="zstd")

    def _read(self, file: Path) -> pyarrow.Table:
        try:
            return parquet.read_table(file, schema=self._schema)
        except (OSError, pyarrow.ArrowException) as error:
            why = f"{file} cannot be read: {error}; remove it to have its runs again"
            raise InputError(why) from error


def _kind(variation: Variation) -> pyarrow.DataType:
    types = {type(value) for value in variation.values} or {
        int if variation.how == "whole" else float
    }
    if bool in types or str in types:
        return pyarrow.bool_() if bool in types else pyarrow.string()
    return pyarrow.int64() if types == {int} else pyarrow.float64()
