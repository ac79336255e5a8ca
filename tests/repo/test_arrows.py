"""What each folder includes or imports, against the table in CONTRIBUTING.md."""

import re
from collections import defaultdict
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path, PurePosixPath

from limber.paths import ROOT

TABLE = ROOT / "CONTRIBUTING.md"
CXX = re.compile(r'^#include ["<]([^">]+)[">]')
PACKAGES = {"limber": "tools", "limber_qa": "qa", "limber_lecture": "lecture"}  # and their folders
PYTHON = re.compile(r"^\s*(?:from (limber[\w.]*) import (\w+)|import (limber[\w.]*))")


def table() -> dict[str, tuple[list[str], list[str]]]:
    """Folder -> what it may include, and the exceptions."""
    section = TABLE.read_text(encoding="utf-8").split("## Folders and arrows")[1].split("\n## ")[0]
    rows = {}
    for line in section.splitlines():
        if match := re.match(r"\| `([^`]+)` \|([^|]*)\|", line):
            allowed, _, denied = match[2].partition(" except ")
            rows[match[1]] = re.findall("`([^`]+)`", allowed), re.findall("`([^`]+)`", denied)
    return rows


def includes(path: Path) -> Iterator[tuple[int, str]]:
    """Line number and path, from the root, of every file of this repository that is included."""
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if path.suffix == ".py" and (match := PYTHON.match(line)):
            package, _, rest = (match[1] or match[3]).partition(".")
            module = "/".join((PACKAGES[package], package, *rest.split("."))).rstrip("/")
            files = (f"{module}/{match[2]}.py", f"{module}.py")
            yield (
                number,
                next((f for f in files if (ROOT / f).exists()), f"{module}/__init__.py"),
            )
        elif path.suffix != ".py" and (match := CXX.match(line)):
            target = re.sub("^limber/", "lcmtypes/", match[1])  # generated headers
            if (ROOT / target).exists() or target.startswith("lcmtypes/"):
                yield number, target


def inside(file: str, name: str) -> bool:
    """`name` is a folder, with a slash at its end one without its subfolders, or the beginning of
    a file's path.
    """
    if name.endswith("/"):
        return PurePosixPath(file).parent == PurePosixPath(name)
    return file.startswith((name + "/", name + ".")) or file == name


def sources() -> Iterator[Path]:
    for folder in sorted({row.split("/")[0] for row in table()}):
        for suffix in ("*.h", "*.cc", "*.py"):
            yield from sorted((ROOT / folder).rglob(suffix))


def test_every_include_follows_an_arrow():
    rows = table()
    wrong, used = [], set()
    for path in sources():
        file = path.relative_to(ROOT).as_posix()
        if file.startswith("tools/limber/lcmtypes/"):
            continue
        row = max((row for row in rows if inside(file, row)), key=len)
        used.add(row)
        allowed, denied = rows[row]
        for number, target in includes(path):
            own = inside(target, row) and not any(inside(target, other) for other in denied)
            fits = any(inside(target, other) for other in allowed)
            if not own and (not fits or any(inside(target, other) for other in denied)):
                wrong.append(f"{file}:{number}: {row} may not include {target}")
    assert not wrong, "against the table in CONTRIBUTING.md:\n" + "\n".join(wrong)
    assert used == set(rows), "rows without a file"


def test_python_packages_have_an_order():
    """No two sub-packages of tools/limber lead to each other."""
    graph = defaultdict(set)
    for path in (ROOT / "tools" / "limber").glob("*/*.py"):
        graph[path.parent.name] |= {
            PurePosixPath(target).parts[2]
            for _, target in includes(path)
            if target.count("/") > 2 and not inside(target, f"tools/limber/{path.parent.name}")
        }
    try:
        tuple(TopologicalSorter(graph).static_order())
    except CycleError as error:
        raise AssertionError(f"in a circle: {' <- '.join(error.args[1])}") from None
