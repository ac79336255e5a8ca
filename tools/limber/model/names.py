"""What a name may consist of: the rule of common/names.h."""

import re
from pathlib import Path
from typing import Any

from limber.errors import InputError

NAME = re.compile(r"[A-Za-z0-9](?:[A-Za-z0-9 _.-]{0,62}[A-Za-z0-9_.-])?")
RULE = "a letter or digit, then letters, digits, blanks, _ . or -, at most 64"
SHOWN = 40


def require_name(name: Any, file: Path, key: str = "name") -> str:
    """The name of a robot, a bus or a scenario in `file`. Raises InputError."""
    text = str(name)
    if not NAME.fullmatch(text):
        shown = repr(text if len(text) <= SHOWN else text[:SHOWN] + "...")
        raise InputError(f"{file}{_line(file, key)}: {key}: {shown} is no name; expected {RULE}")
    return text


def _line(file: Path, key: str) -> str:
    """Of the key at the top of a file that was read."""
    lines = file.read_text(encoding="utf-8").splitlines()
    found = [number for number, line in enumerate(lines, 1) if line.startswith(f"{key}:")]
    return f":{found[0]}" if found else ""
