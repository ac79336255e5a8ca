"""The fault matrix: its reader is strict, every row has a runner, and the lock-step rows hold."""

import re
from dataclasses import replace

import pytest

from limber.errors import InputError
from limber.paths import ROOT
from limber_qa.faults import report
from limber_qa.faults.lockstep import fault_names, run_fault
from limber_qa.faults.matrix import LockStepRun, NamedTest, read_matrix

ROWS = read_matrix()
DOUBLED = "two motors with one identifier"
RUNS = [(row, run) for row in ROWS for run in row.lock_step]


def parameters():
    """Runs that are known to fail have to: a cure turns them red."""
    for row, run in RUNS:
        marks = []
        if run.known_failing:
            marks = [pytest.mark.xfail(strict=True, reason=run.known_failing)]
        yield pytest.param(run, id=f"{row.number}-{run.fault}-{run.family}", marks=marks)


@pytest.mark.parametrize("run", list(parameters()))
def test_in_lock_step(run):
    result = run_fault(run)
    assert result.problems == []


@pytest.mark.parametrize("family", ["moteus", "cia402", "myactuator", "cubemars", "odrive"])
@pytest.mark.parametrize(
    "run",
    [
        LockStepRun("controller silent", "FALLBACK", cause="CONTROLLER_LOST", cycles=4),
        LockStepRun("all motors silent", "FALLBACK", cause="REPLY_LOST", cycles=4),
        LockStepRun("one motor silent", "FALLBACK", cause="REPLY_LOST", cycles=4),
        LockStepRun("the drive reports an error", "FALLBACK", cause="DRIVE_ERROR", cycles=2),
        LockStepRun("torque NaN", "FALLBACK", cause="COMMAND_REFUSED", cycles=4),
    ],
    ids=lambda run: run.fault,
)
def test_other_families_of_drives(run, family):
    assert run_fault(replace(run, family=family), phases=2).problems == []


def test_a_wrong_expectation_is_found():
    """The judge of the runs is no yes-man: each part of an expectation counts."""
    right = LockStepRun("controller silent", "FALLBACK", cause="CONTROLLER_LOST", cycles=4)
    assert run_fault(right, phases=2).passed
    for wrong, words in (
        (replace(right, cycles=2), "expected within 2"),
        (replace(right, cycles=2), "first safe frame"),
        (replace(right, cause="BUS"), "expected BUS"),
        (replace(right, reaction="DAMP"), "expected DAMP"),
        (LockStepRun("a second controller", "refused", verdict="SIZE"), "expected SIZE"),
        (LockStepRun("controller silent", "bridged"), "expected none"),
        (LockStepRun("two answers lost in a row", "refused"), "no command was refused"),
        (LockStepRun("two answers lost in a row", "kept still", moved_rad=0.001), "moved"),
        (replace(right, moved_on_rad=1e-6), "while the drives were ON"),
        (LockStepRun(DOUBLED, "FALLBACK", joint=2, cycles=12), "names joint 1, expected 2"),
        (LockStepRun("two answers lost in a row", "stopped", moved_rad=1.0), "never left ON"),
        (LockStepRun("controller silent", "stopped", moved_rad=1e-6), "moved"),
    ):
        problems = run_fault(wrong, phases=2).problems
        assert any(words in problem for problem in problems), (wrong, problems)


def test_there_are_55_rows():
    assert len(ROWS) == 55


def test_every_fault_is_one_of_limber_faults_and_each_is_in_a_row():
    names = fault_names()
    for _, run in RUNS:
        assert run.family in names.get(run.fault, []), run.fault
    # Shares of losses are judged by the table of docs/bus.md alone.
    of_shares = {"0.5 % of the replies lost", "5 % of the replies lost"}
    assert set(names) - {run.fault for _, run in RUNS} == of_shares


def exists(run: NamedTest) -> bool:
    file, _, name = run.test.partition("::")
    path = ROOT / file
    if not path.is_file():
        return False
    text = path.read_text(encoding="utf-8")
    if file.endswith(".py"):
        return f"def {name}(" in text
    suite, _, test = name.partition(".")
    return re.search(rf"TEST(_F|_P)?\({suite},\s*{test}\)", text) is not None


def test_every_test_that_a_row_names_exists():
    missing = [run.test for row in ROWS for run in row.tests if not exists(run)]
    assert missing == []
    assert not exists(NamedTest("start", "tests/repo/test_lists.py::test_that_is_not_there"))


def test_the_page_has_every_row():
    text = report.PAGE.read_text(encoding="utf-8")
    for row in ROWS:
        start = f"| {row.number} | {row.fault} | {row.reaction} | {report.limit_text(row)} |"
        assert start in text, f"row {row.number}: run ./limber dev faults report"
        known = any(run.known_failing for run in [*row.lock_step, *row.tests])
        verdict = "not run" if row.not_run else "failing" if known else "ok"
        line = next(line for line in text.splitlines() if line.startswith(start))
        assert line.endswith(f"| {verdict} |"), line


SLIPS = [
    ("number: 1\n", "number: 7\n", "expected 1, 2, 3"),
    ("    place: controller\n", "", "'place' is missing"),
    ("    cycles: 4\n", "    cycles: 0\n", "expected more than 0"),
    ("    cycles: 4\n", "    cycles: four\n", "expected int"),
    ("    cycles: 4\n", "    cycle: 4\n", "unknown key 'cycle'"),
    ("    cycles: 4\n", "    cycles: 4\n    cycles: 5\n", "comes twice"),
    ("reaction: FALLBACK, cause", "reaction: STOP, cause", "none of FALLBACK"),
    ("reaction: FALLBACK, cause", "reaction: bridged, cause", "cycles are for"),
    ("how: processes", "how: somewhere", "none of processes"),
    ("test_kill.py::test_controller_dies", "test_kill.py", "no FILE::NAME"),
    ("limber-fault-matrix/1", "limber-fault-matrix/2", "format is"),
    ("rows:\n", "rows: 3\nothers:\n", "unknown key 'others'"),
]


@pytest.mark.parametrize(("old", "new", "words"), SLIPS)
def test_slips_are_named(tmp_path, old, new, words):
    text = (ROOT / "qa" / "faults" / "matrix.yaml").read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / "matrix.yaml"
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(InputError, match=re.escape(words)):
        read_matrix(path)


def test_a_row_is_run_or_says_why_not(tmp_path):
    text = (ROOT / "qa" / "faults" / "matrix.yaml").read_text(encoding="utf-8")
    path = tmp_path / "matrix.yaml"
    path.write_text(text + '    not_run: "the last row has runs"\n', encoding="utf-8")
    with pytest.raises(InputError, match="either runs or not_run"):
        read_matrix(path)
