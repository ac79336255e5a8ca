"""How files get into a folder of results: no link is followed, nothing foreign is written over.

A new file must not be there yet, not even as a link that points nowhere. A file that limber itself
wrote before, such as the summary of a run that is measured again, is replaced as a whole: whoever
reads it sees the old one or the new one, and a link of that name gives way to the file.
"""

import os
from contextlib import suppress
from pathlib import Path
from typing import IO, Any

from limber.errors import InputError, LimberError, RunError


def new_file(path: Path, mode: str = "w") -> IO[Any]:
    """Opened for writing, as text in UTF-8 or, with `mode` "wb", as bytes. Raises InputError."""
    encoding = None if "b" in mode else "utf-8"
    try:
        return open(path, mode.replace("w", "x"), encoding=encoding)
    except FileExistsError as error:
        kind = "is a link" if path.is_symlink() else "exists already"
        raise InputError(f"{path} {kind}: give another --out, or remove it") from error
    except OSError as error:
        raise _failure(path, error) from error


def write_new(path: Path, text: str) -> None:
    """A file that must not be there yet. Raises InputError."""
    with new_file(path) as file:
        file.write(text)


def copy_new(source: Path, path: Path) -> None:
    """The same, from another file."""
    with new_file(path, "wb") as file:
        file.write(source.read_bytes())


def write_again(path: Path, text: str) -> None:
    """A file of limber's own, new or in place of an earlier one. Raises
    InputError or RunError.
    """
    part = path.with_name(f".part-{path.name}")
    try:
        part.unlink(missing_ok=True)
        with open(part, "x", encoding="utf-8") as file:
            file.write(text)
        os.replace(part, path)
    except OSError as error:
        with suppress(OSError):
            part.unlink(missing_ok=True)
        raise _failure(path, error) from error


def _failure(path: Path, error: OSError) -> LimberError:
    """A folder that cannot be written to is the user's choice, a full disk is not."""
    place = FileNotFoundError | NotADirectoryError | IsADirectoryError | PermissionError
    kind = InputError if isinstance(error, place) else RunError
    return kind(f"{path} cannot be written: {error.strerror}")
