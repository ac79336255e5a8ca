"""`limber test lint`: what one of its tools finds fails it, and types are among it."""

import pytest

from limber_qa import lint

UNTYPED = "def half(x):\n    return x / 2\n"
WRONG = "def half(x: float) -> str:\n    return x / 2\n"
RIGHT = "def half(x: float) -> float:\n    return x / 2\n"


@pytest.mark.parametrize(("code", "good"), [(UNTYPED, False), (WRONG, False), (RIGHT, True)])
def test_types_are_judged(code, good, monkeypatch, tmp_path):
    (tmp_path / "half.py").write_text(code)
    mypy = ("mypy", "--cache-dir", str(tmp_path / "cache"), str(tmp_path / "half.py"))
    monkeypatch.setattr(lint, "TOOLS", (mypy, ("ruff", "--version")))
    assert lint.run() == good
