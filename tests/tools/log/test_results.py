"""Files are written whole, or not at all."""

import errno

import pytest

from limber.errors import InputError, RunError
from limber.log.results import complete_or_nothing, written_whole


def test_what_fails_leaves_the_old_file_and_no_other(tmp_path):
    target = tmp_path / "plot.html"
    target.write_text("old")
    told = pytest.raises(RunError, match=r"plot\.html cannot be written: No space left")
    with told, written_whole(target) as part:
        part.write_text("ha")
        raise OSError(errno.ENOSPC, "No space left on device")
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]
    with written_whole(target) as part:
        part.write_text("new")
    assert target.read_text() == "new"
    assert list(tmp_path.iterdir()) == [target]


def test_nothing_is_overwritten_unasked(tmp_path):
    target = tmp_path / "made" / "run.mcap"
    with complete_or_nothing(target) as part:
        part.write_text("first")
    with pytest.raises(InputError, match="exists already"), complete_or_nothing(target):
        pass
    assert target.read_text() == "first"
