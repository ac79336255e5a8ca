"""Writes the page of the fault matrix, qa/fault_matrix.md: every row with its worst number."""

from pathlib import Path

from limber.paths import ROOT
from limber_qa.faults.lockstep import RunResult, run_row
from limber_qa.faults.matrix import TESTS, LockStepRun, NamedTest, Row, read_matrix

PAGE = ROOT / "qa" / "fault_matrix.md"

HEAD = """# The fault matrix

What may fail, what limber has to make of it, and whether it does. The rows, and what they expect,
are in [faults/matrix.yaml](faults/matrix.yaml); `limber dev faults report` runs them and writes
this page, `limber dev faults run ROW` runs one. *Safe frame*: the first frame on the bus that no
longer has a drive follow the controller, counted from the injection to the slowest drive, the worst
of all phases, as [`limber dev check-trace`](check_trace.md) reads it from the CAN trace. A
*failing* row is wrong today.
"""


def limit_text(row: Row) -> str:
    """ "4 cycles", "20 ms", or nothing."""
    if row.cycles is not None:
        return f"{row.cycles} cycles"
    return "" if row.limit_ms is None else f"{row.limit_ms:g} ms"


def how_text(row: Row) -> str:
    """How a row is run, in a few words."""
    if row.not_run:
        return f"not run: {row.not_run}"
    ways = ["lock step"] if row.lock_step else []
    for word, text in TESTS.items():
        if any(test.how == word for test in row.tests):
            ways.append(text)
    return ", ".join(ways)


def write(phases: int, path: Path = PAGE) -> tuple[Path, int]:
    """Runs all rows; the page and how many rows are neither right nor known to fail."""
    rows = read_matrix()
    results = {row.number: list(run_row(row, phases)) for row in rows}
    path.write_text(page(rows, results, phases), encoding="utf-8")
    wrong = [number for number, runs in results.items() if any(map(_unexpected, runs))]
    return path, len(wrong)


def _unexpected(result: RunResult) -> bool:
    return result.passed == bool(result.run.known_failing)


def page(rows: list[Row], results: dict[int, list[RunResult]], phases: int) -> str:
    sections = [HEAD, _summary(rows, results, phases), _overview(rows, results)]
    sections += [_failing(rows, results), _not_run(rows), _lock_step(rows, results)]
    return "\n".join(sections)


def _summary(rows: list[Row], results: dict[int, list[RunResult]], phases: int) -> str:
    runs = [result for found in results.values() for result in found]
    words = [verdict(row, results[row.number]) for row in rows]
    return (
        f"{len(rows)} rows: {words.count('ok')} ok, {words.count('failing')} failing, "
        f"{words.count('NOT AS EXPECTED')} not as expected, {words.count('not run')} not run. "
        "What tests elsewhere show counts as long as `limber test` passes. "
        f"{len(runs)} faults in lock step at {phases} phases: {len(runs) * phases} runs.\n"
    )


def verdict(row: Row, results: list[RunResult]) -> str:
    """Tests elsewhere pass or fail in `limber test`; what is known of them counts here."""
    if row.not_run:
        return "not run"
    if any(map(_unexpected, results)):
        return "NOT AS EXPECTED"
    runs: list[LockStepRun | NamedTest] = [*row.lock_step, *row.tests]
    known = any(run.known_failing for run in runs)
    return "failing" if known else "ok"


def _overview(rows: list[Row], results: dict[int, list[RunResult]]) -> str:
    lines = [_line("no.", "fault", "expected", "limit", "safe frame", "run as", "verdict")]
    lines.append(_line(*["---"] * 7))
    for row in rows:
        stops = [result.stop_ms for result in results[row.number] if result.stop_ms is not None]
        worst = f"{max(stops):g} ms" if stops else ""
        how = "" if row.not_run else how_text(row)
        word = verdict(row, results[row.number])
        lines.append(
            _line(str(row.number), row.fault, row.reaction, limit_text(row), worst, how, word)
        )
    return "\n".join([*lines, ""])


def _failing(rows: list[Row], results: dict[int, list[RunResult]]) -> str:
    lines = ["## Failing today", "", _line("no.", "what", "why", "measured"), _line(*["---"] * 4)]
    for row in rows:
        for result in results[row.number]:
            if result.problems:
                why = result.run.known_failing or "**not expected**"
                worst = f"{result.problems[0].split(': ', 1)[1]}; {_motion(result)}"
                lines.append(_line(str(row.number), result.run.fault, why, worst))
        for test in row.tests:
            if test.known_failing:
                name = test.test.partition("::")[2]
                lines.append(_line(str(row.number), f"`{name}`", test.known_failing, ""))
    return "\n".join([*lines, ""])


def _not_run(rows: list[Row]) -> str:
    lines = ["## Not run", "", _line("no.", "fault", "reason"), _line(*["---"] * 3)]
    lines += [_line(str(row.number), row.fault, row.not_run) for row in rows if row.not_run]
    return "\n".join([*lines, ""])


def _lock_step(rows: list[Row], results: dict[int, list[RunResult]]) -> str:
    columns = ("no.", "fault", "expected", "left ON after", "safe frame", "motion", "verdict")
    lines = ["## In lock step", "", _line(*columns), _line(*["---"] * len(columns))]
    for row in rows:
        for result in results[row.number]:
            run = result.run
            limits = [f"{run.cycles}"] if run.cycles else []
            limits += [f"{run.moved_on_rad:g} rad"] if run.moved_on_rad else []
            expected = run.reaction + (f" within {' and '.join(limits)}" if limits else "")
            left = f"{result.cycles} cycles" if result.cycles > 0 else "never"
            stop = "" if result.stop_ms is None else f"{result.stop_ms:g} ms"
            word = "ok" if result.passed else "failing"
            lines.append(
                _line(str(row.number), run.fault, expected, left, stop, _motion(result), word)
            )
    return "\n".join([*lines, ""])


def _motion(result: RunResult) -> str:
    """While the drives were ON, where that is limited, and in all."""
    on = f"{result.moved_on_rad:.2f} rad ON, " if result.run.moved_on_rad else ""
    return f"{on}{result.moved_rad:.2f} rad, {result.speed_rad_per_s:.2f} rad/s"


def _line(*cells: str) -> str:
    return "| " + " | ".join(cell.replace("|", "/") for cell in cells) + " |"
