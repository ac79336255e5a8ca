"""Writes an LCM event log, plain or in compressed frames as limber-record makes them."""

from pathlib import Path

import zstandard

BLOCK_BYTES = 1 << 18


class EventWriter:
    def __init__(self, path: Path, compress: bool) -> None:
        self._file = open(path, "wb")  # noqa: SIM115
        self._compressor = zstandard.ZstdCompressor(write_checksum=True) if compress else None
        self._block = bytearray()

    def write(self, event: bytes) -> None:
        """A whole event with its header."""
        self._block += event
        if len(self._block) >= BLOCK_BYTES:
            self._flush()

    def close(self) -> None:
        self._flush()
        self._file.close()

    def _flush(self) -> None:
        block = bytes(self._block)
        if block:
            self._file.write(self._compressor.compress(block) if self._compressor else block)
        self._block.clear()
