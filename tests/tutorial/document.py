"""A document whose code blocks can be carried out.

    `path/of/a/file.cc`:                          the next block is that file,
    At the end of `path/of/a/file.yaml`:          or what is appended to it,
    `path/of/a/file.cc`: and a block of ```diff   or a change of it, without line numbers.

A block that starts with `$ ` holds commands, each followed by what it prints, or by nothing if that
does not matter.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path

BLOCK = re.compile(
    r"(?:^(?P<above>[^\n]+)\n\n?)?^```(?P<kind>\w*)\n(?P<text>.*?)^```$", re.M | re.S
)


@dataclass(frozen=True)
class Edit:
    path: str
    text: str
    kind: str  # whole, append or diff

    def apply(self, root: Path, to: Path) -> None:
        """Writes the file to the folder `to` as it should become in `root`."""
        before = root / self.path
        old = before.read_text(encoding="utf-8") if before.exists() else ""
        (to / self.path).parent.mkdir(parents=True, exist_ok=True)
        (to / self.path).write_text(self._changed(old), encoding="utf-8")

    def _changed(self, old: str) -> str:
        if self.kind != "diff":
            return (old if self.kind == "append" else "") + self.text
        lines = self.text.splitlines(keepends=True)
        found = "".join(line[1:] for line in lines if line[0] in " -")
        assert old.count(found) == 1, f"{self.path}: these lines are not there:\n{found}"
        return old.replace(found, "".join(line[1:] for line in lines if line[0] in " +"))


@dataclass
class Command:
    text: str
    expected: list[str] = field(default_factory=list)


def read(path: Path) -> list[Edit | Command]:
    steps: list[Edit | Command] = []
    for block in BLOCK.finditer(path.read_text(encoding="utf-8")):
        name = re.fullmatch(r"(At the end of )?`([^`]+)`:", block["above"] or "")
        if name:
            kind = "append" if name[1] else "diff" if block["kind"] == "diff" else "whole"
            steps.append(Edit(name[2], block["text"], kind))
        elif block["text"].startswith("$ "):
            for line in block["text"].splitlines():
                if line.startswith("$ "):
                    steps.append(Command(line[2:]))
                else:
                    steps[-1].expected.append(line)
    return steps


def difference(expected: list[str], printed: str) -> str:
    """Empty if nothing is expected, or words are equal and numbers within 1e-6, times left out; a
    last line ... stands for all that follows.
    """
    if not expected:
        return ""
    rest_left_out = expected[-1].strip() == "..."
    words, found = (_words(text) for text in ("\n".join(expected), printed))
    if rest_left_out:
        words = words[:-1]
        found = found[: len(words)]
    for i, (word, other) in enumerate(zip(words, found, strict=False)):
        if word != other and not _close(word, other):
            return f"'{' '.join(found[i : i + 8])}' instead of '{' '.join(words[i : i + 8])}'"
    return "" if len(words) == len(found) else f"{len(found)} words instead of {len(words)}"


def _words(text: str) -> list[str]:
    return re.sub(r"\([\d.]+ ms( total)?\)|in [\d.]+ s: [\d.]+ times", "", text).split()


def _close(a: str, b: str) -> bool:
    try:
        x, y = float(a.strip("[],")), float(b.strip("[],"))
    except ValueError:
        return False
    return abs(x - y) <= 1e-6 * max(abs(x), abs(y)) + 1e-7
