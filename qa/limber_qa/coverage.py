"""`limber dev coverage`: lines and branches of the deciding sources that their unit tests reach.

The figures stand in tests/deciders/coverage.yaml and may rise, but not fall. A source that is not
listed there has to be covered in full.
"""

import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import yaml

from limber.errors import RunError
from limber.paths import ROOT

FIGURES = ROOT / "tests" / "deciders" / "coverage.yaml"
_BUILD = ROOT / "build" / "coverage"
_HEAD = """\
# Covered by test_deciders, % of lines and of branches. `limber dev coverage` fails if a figure
# falls; after a rise, `limber dev coverage --write` writes this file.
"""
# Of these folders and files, as regular expressions.
_SOURCES = (r".*/drivers/gate/", r".*/drivers/drive/", r".*/drivers/controller_watch",
            r".*/controller/modes/", r".*/controller/watches/")  # fmt: skip
_FULL = (100.0, 100.0)


@dataclass(frozen=True)
class Figure:
    """Of one source, %, rounded down to tenths."""

    file: str
    lines: float
    branches: float
    before: tuple[float, float] = _FULL  # as FIGURES has it

    @property
    def fell(self) -> bool:
        return self.lines < self.before[0] or self.branches < self.before[1]

    @property
    def rose(self) -> bool:
        return not self.fell and (self.lines, self.branches) != self.before


def measure(figures: Path = FIGURES) -> list[Figure]:
    """Builds the tests so that they count, runs them, compares with the file. RunError if that
    fails.
    """
    _run([
        "cmake", "--preset", "dev", "-B", str(_BUILD), "-DCMAKE_BUILD_TYPE=Debug",
        "-DCMAKE_CXX_FLAGS=--coverage", "-DLIMBER_FOLDERS=lcmtypes;common;robots",
    ])  # fmt: skip
    _run(["ninja", "-C", str(_BUILD), "test_deciders"])
    for counts in _BUILD.rglob("*.gcda"):
        counts.unlink()
    _run([str(_BUILD / "tests" / "test_deciders"), "--gtest_brief=1"])
    summary = _run([
        sys.executable, "-m", "gcovr", "--root", str(ROOT), ".", "--exclude", ".*/tests/",
        *(word for source in _SOURCES for word in ("--filter", source)),
        "--exclude-throw-branches", "--exclude-unreachable-branches", "--json-summary", "-",
    ], _BUILD / "tests" / "deciders")  # fmt: skip
    before = yaml.safe_load(figures.read_text(encoding="utf-8")) if figures.is_file() else {}
    return compared(json.loads(summary)["files"], before)


def compared(files: list[dict], before: dict[str, dict[str, float]]) -> list[Figure]:
    """`files`: as gcovr's summary has them."""
    found = []
    for file in files:
        name = file["filename"]
        old = before.get(name)
        known = (old["lines"], old["branches"]) if old else _FULL
        found.append(Figure(name, _percent(file, "line"), _percent(file, "branch"), known))
    return found


def write(found: list[Figure], figures: Path = FIGURES) -> None:
    """Keeps these figures."""
    content = {each.file: {"lines": each.lines, "branches": each.branches} for each in found}
    text = yaml.safe_dump(content, default_flow_style=None, sort_keys=True)
    figures.write_text(_HEAD + text, encoding="utf-8")


def _percent(file: dict, what: str) -> float:
    total = file[f"{what}_total"]
    return 100.0 if total == 0 else 1000 * file[f"{what}_covered"] // total / 10


def _run(command: list[str], folder: Path = ROOT) -> str:
    try:
        done = subprocess.run(command, cwd=folder, check=False, capture_output=True, text=True)
    except FileNotFoundError as error:
        raise RunError(f"{command[0]} is missing") from error
    if done.returncode != 0:
        output = (done.stdout + done.stderr)[-4000:]
        raise RunError(f"{' '.join(command[:3])} ... failed:\n{output}")
    return done.stdout
