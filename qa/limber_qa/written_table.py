"""Tables in the docs that a program writes."""

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
        return text[:begin] + "\n".join(["", *self.lines(), "", ""]) + text[end:]

    def write(self) -> bool:
        """False if it stood there already."""
        before = self.path.read_text(encoding="utf-8")
        after = self.updated(before)
        self.path.write_text(after, encoding="utf-8")
        return after != before
