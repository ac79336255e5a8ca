"""`limber dev fuzz`: bytes of unknown origin for everything that reads some (tests/fuzz).

libFuzzer tries the kept inputs, and new ones that it makes of them. How many a long search has
tried is kept in TRIED.
"""

import json
import os
import re
import subprocess
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path

from rich.console import Console

from limber import tables
from limber.errors import InputError, RunError
from limber.paths import ROOT
from limber_qa.written_table import WrittenTable

FOLDER = ROOT / "tests" / "fuzz"
CORPUS = FOLDER / "corpus"
TRIED = FOLDER / "tried.json"
OUT = ROOT / "out" / "fuzz"
# Inputs that `limber test` tries; files go through a folder and a whole loader, and a controller
# gets to ACTIVE for each input.
TRIES = 20_000
FILE_TRIES = 2_000
CONTROLLER_TRIES = 300
TEXTS = ("robot_yaml", "scenario", "urdf")
FILES = ("joint_command", *TEXTS)
CONTROLLERS = ("joint_state", "streams")
# libFuzzer lengthens inputs up to 4096 bytes, which costs time and finds no other lines of code.
SHORT = ("black_box", "joint_command", "joint_state", "lcm_fragments", "shared_memory", "streams")
LONGEST = dict.fromkeys(SHORT, 256) | dict.fromkeys(TEXTS, 1024)


def _what() -> dict[str, str]:
    """Targets, and the first sentence of each file's comment."""
    found = {}
    for path in sorted(FOLDER.glob("*.cc")):
        text = path.read_text(encoding="utf-8")
        if "LLVMFuzzerTestOneInput" in text:
            comment = " ".join(
                line.removeprefix("//").strip()
                for line in takewhile(lambda line: line.startswith("//"), text.splitlines())
            )
            found[path.stem] = re.split(r"[.:;] |\.$", comment)[0]
    return found


WHAT = _what()


@dataclass(frozen=True)
class Outcome:
    target: str
    inputs: int
    failure: str = ""


def targets(names: list[str]) -> list[str]:
    """Those with these names; all if there are none."""
    for name in names:
        if name not in WHAT:
            raise InputError(f"no fuzz target '{name}'; there are {', '.join(WHAT)}")
    return names or list(WHAT)


def tries_of(target: str) -> int:
    if target in CONTROLLERS:
        return CONTROLLER_TRIES
    return FILE_TRIES if target in FILES else TRIES


def run(names: list[str], console: Console, inputs: int, minutes: float, seed: int) -> bool:
    """Kept inputs and what libFuzzer makes of them, under sanitizers; True if nothing was found.

    So many inputs or minutes a target; without both, what `limber test` tries.
    """
    folder = _build(names)

    def one(target: str) -> Outcome:
        found = OUT / target
        found.mkdir(parents=True, exist_ok=True)
        runs = inputs or (0 if minutes else tries_of(target))
        command = [folder / f"fuzz_{target}", found, CORPUS / target, "-print_final_stats=1"]
        command += [f"-seed={seed}", "-timeout=10", f"-artifact_prefix={OUT}/{target}-"]
        command += [f"-runs={runs}"] if runs else []
        command += [f"-max_total_time={round(60 * minutes)}"] if minutes else []
        command += [f"-max_len={LONGEST[target]}"] if target in LONGEST else []
        done = subprocess.run(
            list(map(str, command)), cwd=ROOT, capture_output=True, text=True, check=False
        )
        executed = re.search(r"number_of_executed_units: (\d+)", done.stderr)
        count = int(executed[1]) if executed else 0
        return Outcome(target, count, "" if done.returncode == 0 else done.stderr[-4000:])

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        outcomes = list(pool.map(one, names))
    if inputs or minutes:
        remember({outcome.target: outcome.inputs for outcome in outcomes if not outcome.failure})
    return _report(outcomes, console)


def _build(names: list[str]) -> Path:
    """Returns the folder of the targets' programs."""
    programs = ["fuzz_targets"] if names == list(WHAT) else [f"fuzz_{name}" for name in names]
    commands = (
        ["cmake", "--preset", "asan"],
        ["cmake", "--build", "--preset", "asan", "--target", *programs],
    )
    for command in commands:
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise RunError(f"{' '.join(command)} failed:\n{done.stdout}{done.stderr}")
    return ROOT / "build" / "asan" / "fuzz"


def _report(outcomes: list[Outcome], console: Console) -> bool:
    table = tables.table("<target", ">inputs", "~")
    for outcome in outcomes:
        table.add_row(outcome.target, f"{outcome.inputs:,}", tables.verdict(not outcome.failure))
    console.print(table)
    for outcome in outcomes:
        if outcome.failure:
            console.print(f"{outcome.target}: {outcome.failure}", markup=False, soft_wrap=True)
    return not any(outcome.failure for outcome in outcomes)


def tried() -> dict[str, int]:
    """Inputs of the longest run of libFuzzer that found nothing, by target."""
    return json.loads(TRIED.read_text(encoding="utf-8")) if TRIED.exists() else {}


def remember(counts: dict[str, int]) -> None:
    known = tried()
    for target, count in counts.items():
        known[target] = max(count, known.get(target, 0))
    TRIED.write_text(json.dumps(known, indent=2, sort_keys=True) + "\n", encoding="utf-8")


def _lines() -> list[str]:
    lines = ["| target | what it reads | kept | in `limber test` | longest search |"]
    lines.append("|---|---|---|---|---|")
    for target, what in WHAT.items():
        kept = len(list((CORPUS / target).iterdir()))
        searched = tried().get(target, 0)
        lines.append(f"| `{target}` | {what} | {kept} | {tries_of(target):,} | {searched:,} |")
    return lines


TABLE = WrittenTable(ROOT / "qa" / "README.md", "fuzz targets", _lines)
