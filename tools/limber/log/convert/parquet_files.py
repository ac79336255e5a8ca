"""One Parquet file a channel, for pandas, polars and DuckDB."""

from collections.abc import Sequence
from pathlib import Path

import pyarrow
from pyarrow import parquet

from limber.log.convert.csv_files import flat
from limber.log.convert.windows import Batch
from limber.log.events import Event


class ParquetFiles:
    def __init__(self, path: Path, joints: tuple[str, ...]) -> None:
        path.mkdir()
        self._folder, self._joints = path, joints
        self._files: dict[str, parquet.ParquetWriter] = {}

    def begin(self, story: Sequence[Event], arm_time_zero_us: int) -> None:
        columns = {
            "time_s": [event.time_s for event in story],
            "who": [event.who for event in story],
            "what": [event.text for event in story],
            "bad": [event.bad for event in story],
        }
        self._write("events", pyarrow.table(columns))

    def write(self, window: list[Batch]) -> None:
        for batch in window:
            self._write(batch.channel, pyarrow.table(flat(batch, self._joints)))

    def close(self) -> None:
        for file in self._files.values():
            file.close()

    def _write(self, name: str, table: pyarrow.Table) -> None:
        if name not in self._files:
            path = self._folder / f"{name}.parquet"
            self._files[name] = parquet.ParquetWriter(path, table.schema, compression="zstd")
        self._files[name].write_table(table)
