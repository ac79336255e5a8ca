"""`limber test --quick`: format, lint, and the unit tests of what changed, before a commit."""

import re
import shutil
import subprocess
import sys
from pathlib import PurePosixPath

from limber.errors import RunError
from limber.paths import ROOT
from limber_qa.selftest import PARTS, PYTEST, check_format, cxx_files

BUILD = ROOT / "build" / "dev"
# Sources in Python, and their tests.
PYTHON = {"tools/limber": "tests/tools", "qa/limber_qa": "tests/qa", "lecture": "tests/lecture"}


def changed() -> list[str]:
    """Files that differ from the last commit; those of the last commit if there are none."""
    against = _git("diff", "--name-only", "HEAD") + _git(
        "ls-files", "--others", "--exclude-standard"
    )
    return sorted(set(against)) or _git("diff", "--name-only", "HEAD~1")


def _git(*words: str) -> list[str]:
    done = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RunError(f"git {' '.join(words)}: {done.stderr.strip()}")
    return done.stdout.splitlines()


def unit_tests(files: list[str]) -> list[str]:
    """Test programs in C++ of the folders these files lie in."""
    wanted: set[str] = set()
    for file in files:
        if not file.endswith((".h", ".cc", ".yaml", "CMakeLists.txt")):
            continue
        folder = PurePosixPath(file.removeprefix("tests/")).parent
        here = next((f for f in (folder, *folder.parents) if _programs(f)), None)
        wanted.update(_programs(here) if here else ())
    return sorted(wanted)


def _programs(folder: PurePosixPath) -> list[str]:
    """Test programs that mirror a folder and what lies below it."""
    if str(folder) == ".":
        return []
    return [
        f"test_{name}"
        for path in (ROOT / "tests" / folder).rglob("CMakeLists.txt")
        for name in re.findall(r"^limber_tests\((\w+)", path.read_text(), re.MULTILINE)
    ]


def python_tests(files: list[str]) -> list[str]:
    """Folders of tests in Python that mirror these files; of documentation, those of the lists."""
    wanted = set()
    for file in files:
        if file.endswith((".md", "CMakeLists.txt")) or "/" not in file:
            wanted.add("tests/repo")
        if not file.endswith(".py"):
            continue
        for sources, tests in PYTHON.items():
            if file.startswith((f"{sources}/", f"{tests}/")):
                inside = PurePosixPath(file).relative_to(
                    sources if file.startswith(sources) else tests
                )
                folder = ROOT / tests / inside.parts[0]
                wanted.add(f"{tests}/{inside.parts[0]}" if folder.is_dir() else tests)
    return sorted(w for w in wanted if not any(w.startswith(f"{other}/") for other in wanted))


def commands(files: list[str]) -> list[list[str]]:
    made = [PARTS["lint"].command(), [sys.executable, "-m", "ruff", "format", "--check", "."]]
    if sources := [path for path in cxx_files() if str(path) in files]:
        made += [check_format(sources)]
        if shutil.which("clang-tidy"):
            made += [[sys.executable, "-m", "limber", "dev", "tidy"]]
    if programs := unit_tests(files):
        made += [["ninja", "-C", str(BUILD), *programs]]
        made += [[str(BUILD / "tests" / name), "--gtest_brief=1"] for name in programs]
    if tests := python_tests(files):
        made += [[*PYTEST, *tests]]
    return made


def run() -> bool:
    """Ends at the first that fails."""
    return all(
        subprocess.run(command, cwd=ROOT, check=False).returncode == 0
        for command in commands(changed())
    )
