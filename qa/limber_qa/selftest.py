"""`limber test`: everything that CI runs, in three lanes beside one another, and one after them."""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

from rich.console import Console

from limber.errors import InputError, RunError
from limber.live import network
from limber.paths import ROOT

JOBS = os.cpu_count() or 1
LONGEST_PART_S = 2400  # on two processors: 900
FAILED_LINES = 60  # the end of a failed part stands once more below the summary: which, and why
PYTEST = [sys.executable, "-m", "pytest"]
CTEST = ["ctest", "--test-dir", str(ROOT / "build" / "dev"), "--output-on-failure"]


def parts(name: str | None = None) -> list[str]:
    """All parts but those that are run by name alone, or the one with this name."""
    if name is not None and name not in PARTS:
        raise InputError(f"no part '{name}'; there are {', '.join(PARTS)}")
    usual = [name for name, part in PARTS.items() if not part.by_name]
    return usual if name is None else [name]


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


def check_format(files: list[Path]) -> list[str]:
    """The command; of files in C++."""
    clang_format = str(Path(sys.executable).parent / "clang-format")
    return [clang_format, "--dry-run", "-Werror", *map(str, files)]


class Lane(Enum):
    """Parts of a lane run in order. What is not in real time has the lowest priority."""

    REAL_TIME = "real time"  # the processors are theirs when they need them
    BUILDS = "builds"  # another build of the C++ code each
    SIMULATED = "simulated time"
    LAST = "last"  # alone: a guest kernel, or drawing without a graphics card, takes both


AT_ONCE = (Lane.REAL_TIME, Lane.LAST)  # their output comes as they run


@dataclass(frozen=True)
class Part:
    command: Callable[[], list[str]]
    lane: Lane
    by_name: bool = False  # takes minutes of downloads


PARTS: dict[str, Part] = {
    "ctest": Part(
        lambda: [*CTEST, "-L", "plain", "--no-tests=error", "-j", str(JOBS)], Lane.REAL_TIME
    ),
    "system": Part(lambda: _system("not lockstep and not browser"), Lane.REAL_TIME),
    # SocketCAN in a guest kernel that has vcan; one guest at a time
    "vcan": Part(lambda: [*CTEST, "-L", "vcan", "--no-tests=error"], Lane.LAST),
    # The wheel, installed; its compiler's output is build/dev's
    "wheel": Part(lambda: [*PYTEST, "tests/packages"], Lane.BUILDS),
    # The other C++ unit tests, built with sanitizers only
    "sanitizers": Part(
        lambda: [
            "env",
            f"CTEST_PARALLEL_LEVEL={JOBS}",
            "cmake",
            "--workflow",
            "--preset",
            "asan",
        ],
        Lane.BUILDS,
    ),
    "threads": Part(_threads, Lane.BUILDS),
    "fuzz": Part(lambda: _limber("fuzz"), Lane.BUILDS),
    "messages": Part(lambda: [*PYTEST, "tests/fuzz"], Lane.BUILDS),  # with a program of `fuzz`
    # What decides whether the arm moves; the other areas take longer
    "mutation": Part(
        lambda: _limber("mutation", "gate", "tables", "supervisors", "watches", "--seconds", "90"),
        Lane.BUILDS,
    ),
    "coverage": Part(lambda: _limber("coverage"), Lane.BUILDS),
    "format": Part(lambda: check_format(cxx_files()), Lane.SIMULATED),
    "lint": Part(lambda: [sys.executable, "-m", "limber_qa.lint"], Lane.SIMULATED),
    "repo": Part(lambda: [*PYTEST, "tests/repo"], Lane.SIMULATED),
    "lockstep": Part(lambda: _system("lockstep"), Lane.SIMULATED),
    "pytest": Part(
        lambda: [*PYTEST, "tests/tools", "tests/qa", "tests/lecture/experiments"], Lane.SIMULATED
    ),
    "eval": Part(lambda: [*PYTEST, "tests/lecture/eval"], Lane.SIMULATED),
    "soak": Part(lambda: _limber("soak", "--hours", "0.12"), Lane.SIMULATED),
    "requests": Part(
        lambda: _limber("soak", "--robot", "iiwa14", "--any-request", "--hours", "0.05"),
        Lane.SIMULATED,
    ),
    "tutorial": Part(lambda: [*PYTEST, "tests/tutorial"], Lane.SIMULATED),
    "browser": Part(lambda: _system("browser"), Lane.LAST),
    # The wheel in bare Debian 12 and 13; as root
    "bare": Part(lambda: [*PYTEST, "tests/bare"], Lane.LAST, by_name=True),
    # LeRobot's own commands with the plug-in: an environment of 5 GB
    "lerobot": Part(lambda: [*PYTEST, "tests/lerobot"], Lane.LAST, by_name=True),
    # ROS 2's own Python client at the other end of `limber ros2`: 0.25 GB, Python 3.12
    "ros2": Part(lambda: [*PYTEST, "tests/ros2"], Lane.LAST, by_name=True),
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
    processor_s: float  # of all its processes
    output: str


def _run_part(name: str, command: list[str]) -> Verdict:
    """The output comes when the part has ended; of those in real time, at once.

    A part that hangs fails like any other. Its output goes to a file, not to a pipe that what it
    started and left behind would keep open.
    """
    at_once = PARTS[name].lane in AT_ONCE
    command = [*([] if at_once else ["chrt", "--idle", "0"]), *command]
    # Ninja's own number is two more, beside parts in real time.
    environment = {**os.environ, "CMAKE_BUILD_PARALLEL_LEVEL": str(JOBS)}
    start = time.monotonic()
    with tempfile.NamedTemporaryFile("w", encoding="utf-8") as kept:
        try:
            process = subprocess.Popen(
                command, cwd=ROOT, stdout=kept, stderr=subprocess.STDOUT, env=environment
            )
        except FileNotFoundError as error:
            raise RunError(f"{command[0]} is missing: start with ./limber test") from error
        with open(kept.name, encoding="utf-8", errors="replace") as reader, process:
            output, processor_s = "", 0.0
            while True:
                pid, status, used = os.wait4(process.pid, os.WNOHANG)
                ended = pid != 0
                if ended:
                    process.returncode = os.waitstatus_to_exitcode(status)
                    processor_s = used.ru_utime + used.ru_stime
                new = reader.read()
                output += new
                if at_once:
                    print(new, end="", flush=True)
                if ended:
                    break
                if time.monotonic() - start > LONGEST_PART_S:
                    process.kill()
                    output += f"{name}: stopped after {LONGEST_PART_S} s\n"
                time.sleep(0.2)
        passed = process.returncode == 0
        return Verdict(name, passed, time.monotonic() - start, processor_s, output)


def _end_of(output: str) -> list[str]:
    """Its last lines, and pytest's names of what failed, which long comparisons may push out."""
    lines = output.splitlines()
    end = lines[-FAILED_LINES:]
    named = [line[:200] for line in lines[:-FAILED_LINES] if line.startswith(("FAILED ", "ERROR "))]
    return [*named, *end]


def _line(name: str, verdict: str, seconds: float, processor_s: float) -> str:
    return f"{name:10} {verdict} {seconds:6.1f} s, {processor_s:6.1f} s of a processor"


def run(names: list[str], console: Console) -> bool:
    """Runs all parts, also after one has failed; True if all passed."""
    commands = {name: PARTS[name].command() for name in names}
    os.environ["LIMBER_BLACK_BOXES"] = str(ROOT / "out" / "black_boxes")  # tests crash a lot
    begun = time.monotonic()
    verdicts: list[Verdict] = []

    def run_lane(lane: Lane) -> None:
        for name in names:
            if PARTS[name].lane is not lane:
                continue
            if lane in AT_ONCE:
                console.rule(name)
            verdict = _run_part(name, commands[name])
            if verdict.output and lane not in AT_ONCE:
                console.rule(name)
                print(verdict.output, end="", flush=True)
            verdicts.append(verdict)

    beside = [lane for lane in Lane if lane is not Lane.LAST]
    with ThreadPoolExecutor(len(beside)) as pool:
        for lane in [pool.submit(run_lane, lane) for lane in beside]:
            lane.result()
    run_lane(Lane.LAST)
    console.rule("summary")
    for verdict in sorted(verdicts, key=lambda verdict: names.index(verdict.name)):
        text = "[green]passed[/]" if verdict.passed else "[bold red]FAILED[/]"
        console.print(_line(verdict.name, text, verdict.seconds, verdict.processor_s))
    processor_s = sum(verdict.processor_s for verdict in verdicts)
    console.print(_line("all", f"{'':6}", time.monotonic() - begun, processor_s))
    for verdict in (verdict for verdict in verdicts if not verdict.passed):
        console.rule(f"{verdict.name} failed")
        print("\n".join(_end_of(verdict.output)), flush=True)
    return all(verdict.passed for verdict in verdicts)
