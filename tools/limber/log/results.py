"""Files that commands make of a log: never half of one, and not over another one unasked."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from limber.errors import InputError, RunError
from limber.paths import output_folder


@contextmanager
def complete_or_nothing(target: Path) -> Iterator[Path]:
    """As written_whole(), but never over another file."""
    require_new(target)
    output_folder(target.parent)
    with written_whole(target) as part:
        yield part


@contextmanager
def written_whole(target: Path) -> Iterator[Path]:
    """The place to write to; it gets its name when all is written, and goes away if it fails."""
    part = target.with_name(f".part-{target.name}")
    _remove(part)
    try:
        yield part
        part.rename(target)
    except OSError as error:
        raise RunError(f"{target} cannot be written: {error.strerror}") from error
    finally:
        _remove(part)


def require_new(target: Path) -> None:
    if target.exists():
        raise InputError(f"{target} exists already: give another --out, or remove it")


def _remove(path: Path) -> None:
    if path.is_dir():
        shutil.rmtree(path)
    else:
        with suppress(FileNotFoundError):
            path.unlink()
