"""The test programs with all mutants in them: which test reaches which mutant, and who finds it."""

import os
import resource
import subprocess
import tempfile
import time
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from limber.errors import RunError

_CPU_FACTOR = 10  # a mutant that needs this many times what the tests need is one that hangs
_CPU_LEAST_S = 3
_WALL_S = 120.0  # of one that waits and needs no processor


@dataclass(frozen=True)
class RecordedTest:
    """One test of one program, as it runs without a mutant."""

    program: Path
    name: str
    seconds: float
    reached: frozenset[int]


@dataclass(frozen=True)
class Verdict:
    """What became of a mutant; `by` is the test that found it."""

    killed: bool
    by: str = ""


def compiled(program: Path) -> set[int]:
    """The mutants in a program: where the types permitted a change."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "list"
        _run(program, ["--gtest_list_tests"], {"LIMBER_MUTANTS_LIST": str(path)}, 60)
        return _numbers(path)


def test_names(program: Path, without: Iterable[str]) -> list[str]:
    """All that are not disabled; `without`: patterns of GoogleTest."""
    pattern = "*-" + ":".join(without)
    done = _run(program, ["--gtest_list_tests", f"--gtest_filter={pattern}"], {}, 60)
    names, suite = [], ""
    for line in done.stdout.splitlines():
        text = line.split("#")[0].rstrip()
        if text.endswith("."):
            suite = text
        elif line.startswith("  "):
            names.append(suite + text.strip())
    return [name for name in names if "DISABLED_" not in name]


def record(program: Path, name: str) -> RecordedTest:
    """Runs one test without a mutant; RunError if it fails."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "reached"
        start = time.monotonic()
        variables = {"LIMBER_MUTANTS_REACHED": str(path)}
        done = _run(program, [f"--gtest_filter={name}"], variables, 600)
        if done.returncode != 0:
            raise RunError(f"{name} fails without a mutant:\n{done.stdout[-2000:]}")
        return RecordedTest(program, name, time.monotonic() - start, frozenset(_numbers(path)))


def judge(number: int, tests: Iterable[RecordedTest]) -> Verdict:
    """Runs the tests that reach a mutant, the quickest first, until one fails."""
    ordered = sorted(tests, key=lambda test: test.seconds)
    for batch in _batches(ordered):
        names = ":".join(test.name for test in batch)
        needed_s = sum(test.seconds for test in batch)
        cpu_s = max(_CPU_LEAST_S, round(_CPU_FACTOR * needed_s))
        options = [f"--gtest_filter={names}", "--gtest_fail_fast"]
        variables = {"LIMBER_MUTANT": str(number)}
        try:
            done = _run(batch[0].program, options, variables, _WALL_S + needed_s, cpu_s)
        except subprocess.TimeoutExpired:
            return Verdict(True, "time-out")
        if done.returncode != 0:
            failed = [line for line in done.stdout.splitlines() if line.startswith("[  FAILED  ]")]
            return Verdict(True, failed[0].split("]")[1].split()[0] if failed else "crash")
    return Verdict(False)


def _batches(tests: list[RecordedTest]) -> list[list[RecordedTest]]:
    """Tests of one program that run as one process: 0.3 s at first, three times more each time."""
    batches: list[list[RecordedTest]] = []
    room_s = 0.0
    longest_s = 0.1
    for test in tests:
        if not batches or room_s <= 0 or batches[-1][0].program != test.program:
            batches.append([])
            longest_s = min(3 * longest_s, 30.0)
            room_s = longest_s
        batches[-1].append(test)
        room_s -= test.seconds
    return batches


def _numbers(path: Path) -> set[int]:
    return {int(line) for line in path.read_text().split()} if path.is_file() else set()


def _run(
    program: Path, options: list[str], variables: dict[str, str], wall_s: float, cpu_s: int = 0
) -> subprocess.CompletedProcess[str]:
    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        if cpu_s:
            resource.setrlimit(resource.RLIMIT_CPU, (cpu_s, cpu_s + 1))
            resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))

    return subprocess.run(
        [str(program), "--gtest_color=no", *options],
        env={**os.environ, **variables}, capture_output=True, text=True, errors="replace",
        timeout=wall_s, check=False, preexec_fn=limit, stdin=subprocess.DEVNULL,
    )  # fmt: skip
