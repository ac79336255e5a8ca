"""Keys in a terminal, lines in a pipe."""

import os
import pty
import sys
import termios

import pytest

from limber.keys import ENTER, Keys


@pytest.fixture
def pipe(monkeypatch):
    ours, theirs = os.pipe()
    with os.fdopen(ours) as stdin:
        monkeypatch.setattr(sys, "stdin", stdin)
        yield theirs


def test_lines(pipe):
    with Keys() as person:
        assert person.pressed() is None and not person.single
        os.write(pipe, b"Skip\n\nr")
        assert [person.pressed() for _ in range(3)] == ["s", ENTER, None]
        os.write(pipe, b"\n")
        assert person.pressed() == "r" and not person.ended
        person.forget()
        os.close(pipe)
        assert person.pressed() is None and person.ended


def test_lines_written_ahead_are_kept(pipe):
    os.write(pipe, b"s\ns\n")
    with Keys() as person:
        person.forget()
        assert [person.pressed() for _ in range(3)] == ["s", "s", None]
    os.close(pipe)


def test_single_keys(monkeypatch):
    ours, theirs = pty.openpty()
    with os.fdopen(theirs) as stdin:
        monkeypatch.setattr(sys, "stdin", stdin)
        before = termios.tcgetattr(stdin)
        with Keys() as person:
            os.write(ours, b"S\rx")
            assert [person.pressed() for _ in range(4)] == ["s", ENTER, "x", None]
            os.write(ours, b"q")
            person.forget()
            assert person.pressed() is None, "pressed before the question"
        assert termios.tcgetattr(stdin) == before
    os.close(ours)
