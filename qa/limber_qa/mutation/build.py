"""A copy of the tree with all mutants in it, and its test programs."""

import subprocess
import sys
from pathlib import Path

from limber.errors import RunError
from limber.paths import ROOT
from limber_qa.mutation.rewrite import Mutant, rewrite
from limber_qa.mutation.targets import Area

COPY = ROOT / "build" / "mutation"
_BUILD = COPY / "build" / "dev"
_RANGE = 1000  # numbers of a file
_FOLDERS = "lcmtypes;common;robots;scenarios;controller;drivers;sim"


def program(name: str) -> Path:
    return _BUILD / "tests" / name


def mutants_of(areas: list[Area]) -> tuple[dict[str, str], list[Mutant]]:
    """New text of each mutated file, and all mutants. Each file has a range of numbers, so that a
    change in one leaves the others as they were compiled.
    """
    texts: dict[str, str] = {}
    mutants: dict[str, list[Mutant]] = {}
    files = [file for area in areas for file in area.files]
    for place, file in enumerate(sorted(files)):
        source = (ROOT / file).read_text(encoding="utf-8")
        texts[file], mutants[file] = rewrite(source, file, _RANGE * place)
        if len(mutants[file]) > _RANGE:
            raise RunError(f"{file} has more than {_RANGE} mutants")
    return texts, [mutant for file in files for mutant in mutants[file]]


def build(areas: list[Area], texts: dict[str, str], jobs: int) -> None:
    """Writes what has changed and compiles what depends on it."""
    _copy(texts)
    if not (_BUILD / "build.ninja").is_file():
        options = ["-DLIMBER_WERROR=OFF", f"-DLIMBER_FOLDERS={_FOLDERS}"]
        _run(["cmake", "--preset", "dev", *options])
    programs = sorted({name for area in areas for name in area.programs})
    _run(["ninja", "-C", str(_BUILD), f"-j{jobs}", *programs])


def _copy(texts: dict[str, str]) -> None:
    """Files that are the same keep their time, so that only the others are compiled again."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT, check=True, capture_output=True, text=True,
    )  # fmt: skip
    files = {name for name in listed.stdout.split("\0") if name and (ROOT / name).is_file()}
    for name in files:
        content = texts[name].encode() if name in texts else (ROOT / name).read_bytes()
        path = COPY / name
        if not path.is_file() or path.read_bytes() != content:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
    for path in COPY.rglob("*.cc"):
        name = str(path.relative_to(COPY))
        if name not in files and not name.startswith("build/"):
            path.unlink()
    environment = COPY / ".venv"
    if not environment.exists():
        environment.symlink_to(sys.prefix)


def _run(command: list[str]) -> None:
    done = subprocess.run(command, cwd=COPY, check=False, capture_output=True, text=True)
    if done.returncode != 0:
        raise RunError(
            f"{command[0]} failed in {COPY}:\n{done.stdout[-4000:]}{done.stderr[-4000:]}"
        )
