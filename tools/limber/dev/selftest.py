"""`limber test`: everything that CI runs, in order; each part writes its own output."""

import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from rich.console import Console

from limber.errors import InputError, RunError
from limber.live import network
from limber.paths import ROOT

JOBS = os.cpu_count() or 1
PYTEST = [sys.executable, "-m", "pytest"]
CTEST = ["ctest", "--test-dir", str(ROOT / "build" / "dev"), "--output-on-failure"]


def parts(name: str | None = None) -> list[str]:
    """All parts, or the one with this name."""
    if name is not None and name not in PARTS:
        raise InputError(f"no part '{name}'; there are {', '.join(PARTS)}")
    return list(PARTS) if name is None else [name]


def _private() -> list[str]:
    prefix = [] if network.is_private() else network.private_command()
    if prefix is None:
        raise RunError(
            "the system tests need a private network, which this machine does not permit: "
            "run as root, or allow unprivileged user namespaces"
        )
    return prefix


def _threads() -> list[str]:
    """Driver and recorder under thread sanitizer, beside the plain controller and arm."""
    return [*_private(), *PYTEST, "tests/threads"]


def _limber(*words: str) -> list[str]:
    return [sys.executable, "-m", "limber", *words]


def _format() -> list[str]:
    clang_format = str(Path(sys.executable).parent / "clang-format")
    return [clang_format, "--dry-run", "-Werror", *map(str, cxx_files())]


# Name -> its command
PARTS: dict[str, Callable[[], list[str]]] = {
    "ctest": lambda: [*CTEST, "-L", "plain", "--no-tests=error", "-j", str(JOBS)],
    # The other C++ unit tests, built with sanitizers only
    "sanitizers": lambda: [
        "env",
        f"CTEST_PARALLEL_LEVEL={JOBS}",
        "cmake",
        "--workflow",
        "--preset",
        "asan",
    ],
    "fuzz": lambda: _limber("fuzz"),
    "threads": _threads,
    "soak": lambda: _limber("soak", "--hours", "0.12"),
    "pytest": lambda: [*PYTEST, "tests/tools", "tests/fuzz"],
    # What decides whether the arm moves; the other areas take longer
    "mutation": lambda: _limber(
        "mutation", "gate", "tables", "supervisors", "watches", "--seconds", "90"
    ),
    "coverage": lambda: _limber("coverage"),
    "eval": lambda: [*PYTEST, "tests/eval"],
    "system": lambda: [*_private(), *PYTEST, "tests/system"],
    "tutorial": lambda: [*PYTEST, "tests/tutorial"],
    # SocketCAN in a guest kernel that has vcan; one guest at a time
    "vcan": lambda: [*CTEST, "-L", "vcan", "--no-tests=error"],
    "format": _format,
    "lint": lambda: [sys.executable, "-m", "ruff", "check", "."],
    "repo": lambda: [*PYTEST, "tests/repo"],
}


def cxx_folders() -> list[Path]:
    return sorted(path.parent for path in ROOT.glob("*/CMakeLists.txt"))


def cxx_files() -> list[Path]:
    return sorted(
        path.relative_to(ROOT)
        for folder in cxx_folders()
        for pattern in ("*.h", "*.cc")
        for path in folder.rglob(pattern)
    )


def run(names: list[str], console: Console) -> bool:
    """Runs all parts, also after one has failed; True if all passed."""
    commands = {name: PARTS[name]() for name in names}
    verdicts = []
    for number, (name, command) in enumerate(commands.items(), 1):
        console.rule(f"{number} of {len(commands)}: {name}")
        start = time.monotonic()
        try:
            code = subprocess.run(command, cwd=ROOT, check=False).returncode
        except FileNotFoundError as error:
            raise RunError(f"{command[0]} is missing: start with ./limber test") from error
        verdicts.append((name, code == 0, time.monotonic() - start))
    console.rule("summary")
    for name, passed, seconds in verdicts:
        verdict = "[green]passed[/]" if passed else "[bold red]FAILED[/]"
        console.print(f"{name:8} {verdict} {seconds:6.1f} s")
    return all(passed for _, passed, _ in verdicts)
