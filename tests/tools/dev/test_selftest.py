"""The order of `limber test`: what runs by itself, what beside others, and that nothing is lost."""

import subprocess
import sys

import pytest
from rich.console import Console

from limber.dev import selftest
from limber.dev.selftest import Part


def part(code: str, beside: bool = False) -> Part:
    return Part(lambda: [sys.executable, "-c", code], beside)


@pytest.fixture
def parts(monkeypatch):
    def replace(**chosen: Part) -> None:
        monkeypatch.setattr(selftest, "PARTS", chosen)

    return replace


def test_parts_that_may_run_beside_others_are_taken_together(parts):
    parts(a=part(""), b=part("", True), c=part("", True), d=part(""), e=part(""))
    assert list(selftest._groups(list("abcde"))) == [["a"], ["b", "c"], ["d"], ["e"]]


def test_one_failure_fails_all_and_stops_nothing(parts, tmp_path, capfd):
    ran = tmp_path / "ran"
    note = f"open({str(ran)!r}, 'a').write('x'); print('seen')"
    failing = "import sys; print('bad news'); sys.exit(1)"
    parts(a=part(note), b=part(failing, True), c=part(note, True), d=part(note))
    assert not selftest.run(list("abcd"), Console(width=100))
    assert ran.read_text() == "xxx"
    output = capfd.readouterr().out
    assert output.count("seen") == 3
    assert "bad news" in output
    summary = output[output.index("summary") :]
    assert summary.count("passed") == 3
    assert summary.count("FAILED") == 1


def test_all_good_is_good(parts):
    parts(a=part(""), b=part("", True), c=part("", True))
    assert selftest.run(list("abc"), Console(width=100))


def test_every_part_is_a_command_that_exists():
    for name, made in selftest.PARTS.items():
        command = made.command()
        assert subprocess.run(["which", command[0]], capture_output=True).returncode == 0, name
