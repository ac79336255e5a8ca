"""Compressed logs: zstd frames, which give a plain log one after the other.

Frames of limber-record hold whole events and a checksum. A frame that does not agree with it is
left out; one that the file ends in is read as far as it goes.
"""

import mmap
import tempfile
from pathlib import Path
from typing import IO

import zstandard

from limber.errors import RunError

FRAME = zstandard.FRAME_HEADER
PIECE = 1 << 11  # compressed bytes at a time: a block of four may be 128 KiB unpacked


def unpack(data: mmap.mmap, path: Path) -> tuple[IO[bytes], int, int]:
    """A file without a name that holds the plain log; damaged bytes that were left out; bytes of an
    unfinished frame at the end.
    """
    plain = tempfile.TemporaryFile()  # noqa: SIM115
    try:
        return plain, *_unpack(data, plain)
    except OSError as error:
        plain.close()
        raise RunError(
            f"{path} cannot be unpacked in {tempfile.gettempdir()}: {error.strerror}; set TMPDIR "
            f"to a folder with room for about {10 * len(data) / 1e6:.0f} MB"
        ) from error


def _unpack(data: mmap.mmap, plain: IO[bytes]) -> tuple[int, int]:
    skipped, position = 0, 0
    while position < len(data):
        start = plain.tell()
        try:
            after = _frame(data, position, plain)
        except zstandard.ZstdError:
            plain.truncate(start)
            plain.seek(start)
            after = data.find(FRAME, position + 1)
            after = len(data) if after == -1 else after
            skipped += after - position
        if after is None:
            return skipped, len(data) - position
        position = after
    return skipped, 0


def _frame(data: mmap.mmap, position: int, plain: IO[bytes]) -> int | None:
    """Where the frame at `position` ends; None: the file ends in it."""
    decoder = zstandard.ZstdDecompressor().decompressobj()
    while position < len(data):
        piece = data[position : position + PIECE]
        plain.write(decoder.decompress(piece))
        position += len(piece)
        if decoder.eof:
            return position - len(decoder.unused_data)
    return None
