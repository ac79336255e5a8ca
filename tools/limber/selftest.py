"""`limber test`: everything that CI runs, in order; each part's own output is left as it is."""

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from limber import network
from limber.errors import InputError, RunError
from limber.paths import ROOT

FOLDERS = (
    *("common", "robots", "scenarios", "controller", "eval", "drivers", "sim", "lab"),
    *("tools", "tests"),
)


@dataclass(frozen=True)
class Part:
    name: str
    command: list[str]


def parts(label: str | None = None) -> list[Part]:
    """`label` keeps only the parts (ctest, pytest, system, vcan, format, lint) with that name."""
    every = list(_parts())
    chosen = [part for part in every if label in (None, part.name)]
    if not chosen:
        names = ", ".join(part.name for part in every)
        raise InputError(f"no part '{label}': there are {names}")
    return chosen


def _parts() -> Iterator[Part]:
    python = sys.executable
    jobs = str(os.cpu_count() or 1)
    build = str(ROOT / "build" / "dev")
    ctest = ["ctest", "--test-dir", build, "--output-on-failure"]
    yield Part("ctest", [*ctest, "-LE", "vcan", "-j", jobs])
    yield Part("pytest", [python, "-m", "pytest", "tests/tools"])
    yield Part("eval", [python, "-m", "pytest", "tests/eval"])
    prefix = [] if network.is_private() else network.private_command()
    if prefix is None:
        raise RunError(
            "the system tests need a network of their own and this machine does not permit one: "
            "run as root, or allow unprivileged user namespaces"
        )
    yield Part("system", [*prefix, python, "-m", "pytest", "tests/system"])
    # SocketCAN in a guest kernel that has vcan; one guest at a time
    yield Part("vcan", [*ctest, "-L", "vcan", "--no-tests=error"])
    clang_format = str(Path(python).parent / "clang-format")
    yield Part("format", [clang_format, "--dry-run", "-Werror", *map(str, cxx_files())])
    yield Part("lint", [python, "-m", "ruff", "check", "tools", "tests", "experiments"])


def cxx_files() -> Iterator[Path]:
    for folder in (*FOLDERS, "bench"):
        for pattern in ("*.h", "*.cc"):
            yield from sorted(path.relative_to(ROOT) for path in (ROOT / folder).rglob(pattern))


def run(chosen: list[Part], console: Console) -> bool:
    """Runs all parts, also after one has failed; True if all passed."""
    verdicts = []
    for number, part in enumerate(chosen, 1):
        console.rule(f"{number} of {len(chosen)}: {part.name}")
        start = time.monotonic()
        try:
            code = subprocess.run(part.command, cwd=ROOT, check=False).returncode
        except FileNotFoundError as error:
            raise RunError(f"{part.command[0]} is missing: start with ./limber test") from error
        verdicts.append((part.name, code == 0, time.monotonic() - start))
    console.rule("summary")
    for name, passed, seconds in verdicts:
        verdict = "[green]passed[/]" if passed else "[bold red]FAILED[/]"
        console.print(f"{name:8} {verdict} {seconds:6.1f} s")
    return all(passed for _, passed, _ in verdicts)
