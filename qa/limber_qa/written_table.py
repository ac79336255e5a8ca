"""Tables in the docs that a program writes."""

import re
import textwrap
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class WrittenTable:
    """The part of `path` between two comments, the first of which starts with `<!-- NAME:`."""

    path: Path
    name: str
    lines: Callable[[], list[str]]

    def updated(self, text: str) -> str:
        """The text with the table as it should be."""
        begin = text.index("\n", text.index(f"<!-- {self.name}: ")) + 1
        end = text.index(f"<!-- end of {self.name} -->")
        lines = [part for line in self.lines() for part in _wrapped(line)]
        return text[:begin] + "\n".join(["", *lines, "", ""]) + text[end:]

    def write(self) -> bool:
        """False if it stood there already."""
        before = self.path.read_text(encoding="utf-8")
        after = self.updated(before)
        self.path.write_text(after, encoding="utf-8")
        return after != before


COLUMNS = 118


def _wrapped(line: str) -> list[str]:
    """Prose within COLUMNS, code between backquotes in one piece; tables and headings stay."""
    if len(line) <= COLUMNS or line.startswith(("|", "#", "**")):
        return [line]
    kept = re.sub("`[^`]*`", lambda code: code[0].replace(" ", "\0"), line)
    indent = "  " if line.startswith("- ") else ""
    return [
        part.replace("\0", " ")
        for part in textwrap.wrap(
            kept, COLUMNS, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False
        )
    ]
