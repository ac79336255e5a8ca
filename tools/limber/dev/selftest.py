"""`limber test`: everything that CI runs, in order; each part writes its own output."""

import itertools
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
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


def _system(which: str) -> list[str]:
    return [*_private(), *PYTEST, "tests/system", "-m", which]


def _limber(*words: str) -> list[str]:
    return [sys.executable, "-m", "limber", *words]


def _format() -> list[str]:
    clang_format = str(Path(sys.executable).parent / "clang-format")
    return [clang_format, "--dry-run", "-Werror", *map(str, cxx_files())]


@dataclass(frozen=True)
class Part:
    command: Callable[[], list[str]]
    # Runs beside others: it neither fills all processors nor runs in real time
    beside: bool = False


PARTS: dict[str, Part] = {
    "ctest": Part(lambda: [*CTEST, "-L", "plain", "--no-tests=error", "-j", str(JOBS)]),
    # The other C++ unit tests, built with sanitizers only
    "sanitizers": Part(
        lambda: [
            "env",
            f"CTEST_PARALLEL_LEVEL={JOBS}",
            "cmake",
            "--workflow",
            "--preset",
            "asan",
        ]
    ),
    "fuzz": Part(lambda: _limber("fuzz")),
    "threads": Part(_threads),
    "pytest": Part(lambda: [*PYTEST, "tests/tools", "tests/fuzz"], beside=True),
    "lockstep": Part(lambda: _system("lockstep"), beside=True),
    "tutorial": Part(lambda: [*PYTEST, "tests/tutorial"], beside=True),
    # What decides whether the arm moves; the other areas take longer
    "mutation": Part(
        lambda: _limber("mutation", "gate", "tables", "supervisors", "watches", "--seconds", "90"),
        beside=True,
    ),
    "coverage": Part(lambda: _limber("coverage"), beside=True),
    "eval": Part(lambda: [*PYTEST, "tests/eval"], beside=True),
    "soak": Part(lambda: _limber("soak", "--hours", "0.12"), beside=True),
    "repo": Part(lambda: [*PYTEST, "tests/repo"], beside=True),
    "format": Part(_format, beside=True),
    "lint": Part(lambda: [sys.executable, "-m", "ruff", "check", "."], beside=True),
    "system": Part(lambda: _system("not lockstep")),
    # SocketCAN in a guest kernel that has vcan; one guest at a time
    "vcan": Part(lambda: [*CTEST, "-L", "vcan", "--no-tests=error"]),
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


@dataclass(frozen=True)
class Verdict:
    name: str
    passed: bool
    seconds: float


def _run_part(name: str, command: list[str], output: int | None) -> tuple[Verdict, str]:
    start = time.monotonic()
    try:
        done = subprocess.run(
            command, cwd=ROOT, check=False, stdout=output, stderr=subprocess.STDOUT, text=True
        )
    except FileNotFoundError as error:
        raise RunError(f"{command[0]} is missing: start with ./limber test") from error
    return Verdict(name, done.returncode == 0, time.monotonic() - start), done.stdout or ""


def _groups(names: list[str]) -> Iterator[list[str]]:
    """Parts that may run beside one another, together; every other one by itself."""
    for beside, group in itertools.groupby(names, lambda name: PARTS[name].beside):
        if beside:
            yield list(group)
        else:
            for name in group:
                yield [name]


def run(names: list[str], console: Console) -> bool:
    """Runs all parts, also after one has failed; True if all passed. The output of parts that run
    beside others comes when they have ended.
    """
    commands = {name: PARTS[name].command() for name in names}
    os.environ["LIMBER_INCIDENTS"] = str(ROOT / "out" / "incidents")  # tests crash a lot
    verdicts: list[Verdict] = []

    def rule(name: str) -> None:
        console.rule(f"{len(verdicts) + 1} of {len(commands)}: {name}")

    for group in _groups(names):
        if len(group) == 1:
            rule(group[0])
            verdicts.append(_run_part(group[0], commands[group[0]], None)[0])
            continue
        console.print(f"beside one another: {', '.join(group)}")
        with ThreadPoolExecutor(JOBS) as pool:
            runs = [pool.submit(_run_part, name, commands[name], subprocess.PIPE) for name in group]
            for done in as_completed(runs):
                verdict, output = done.result()
                rule(verdict.name)
                print(output, end="", flush=True)
                verdicts.append(verdict)
    console.rule("summary")
    for verdict in verdicts:
        text = "[green]passed[/]" if verdict.passed else "[bold red]FAILED[/]"
        console.print(f"{verdict.name:10} {text} {verdict.seconds:6.1f} s")
    return all(verdict.passed for verdict in verdicts)
