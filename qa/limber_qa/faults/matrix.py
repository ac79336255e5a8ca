"""Reads faults/matrix.yaml: one row a fault, strictly."""

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import yaml

from limber.errors import InputError
from limber.paths import ROOT

FILE = ROOT / "qa" / "faults" / "matrix.yaml"
FORMAT = "limber-fault-matrix/1"
REACTIONS = ("FALLBACK", "DAMP", "FAULT", "bridged", "kept still", "refused", "stopped")
# How a fault is run: in lock step, or as a test of this kind.
TESTS = {
    "processes": "real processes",
    "guest": "real vcan in the guest",
    "start": "at the start",
    "component": "part of the stack",
}


@dataclass(frozen=True)
class LockStepRun:
    """A fault of limber-faults. `cycles`: within so many the drives leave ON; 0: no limit.

    `cause`: of JOINT_STATE, without FAULT_. `joint`: the one that it must name, from 1; 0: any.
    `verdict`: by which most commands are refused, of
    DRIVER_STATUS, without VERDICT_. `moved_rad`: farthest that a joint may move, and
    `moved_on_rad`: while the drives are ON; 0: no limit.
    `unjudged`: why the trace cannot be judged, or "".
    """

    fault: str
    reaction: str
    cause: str = ""
    joint: int = 0
    verdict: str = ""
    cycles: int = 0
    moved_rad: float = 0.0
    moved_on_rad: float = 0.0
    family: str = "damiao_mit"
    unjudged: str = ""
    known_failing: str = ""


@dataclass(frozen=True)
class NamedTest:
    """A test elsewhere: `FILE::NAME` of pytest, `FILE::SUITE.NAME` of GoogleTest."""

    how: str
    test: str
    known_failing: str = ""


@dataclass(frozen=True)
class Row:
    """`cycles` and `limit_ms` from injection to the first safe frame; None: there is no limit."""

    number: int
    fault: str
    place: str
    inject: str
    reaction: str
    cycles: int | None
    limit_ms: float | None
    keep: str
    lock_step: list[LockStepRun]
    tests: list[NamedTest]
    not_run: str


def read_matrix(path: Path = FILE) -> list[Row]:
    """Raises InputError with the row and the key that is wrong."""
    try:
        content = yaml.load(path.read_text(encoding="utf-8"), Loader=_UniqueKeys)
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from error
    except yaml.YAMLError as error:
        raise InputError(f"{path} is not YAML: {' '.join(str(error).split())}") from error
    top = _table(content, f"{path}", {"format": str, "rows": list})
    if top["format"] != FORMAT:
        raise InputError(f"{path}: format is '{top['format']}', expected '{FORMAT}'")
    rows = [_row(entry, f"{path}: row {k}") for k, entry in enumerate(top["rows"], 1)]
    numbers = [row.number for row in rows]
    if numbers != list(range(1, len(rows) + 1)):
        raise InputError(f"{path}: rows are numbered {numbers}, expected 1, 2, 3, ...")
    return rows


class _UniqueKeys(yaml.SafeLoader):
    """A key that comes twice is an error, not the last one's."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        keys = [key.value for key, _ in node.value]
        for key in keys:
            if keys.count(key) > 1:
                raise yaml.constructor.ConstructorError(
                    None, None, f"key '{key}' comes twice", node.start_mark
                )
        return super().construct_mapping(node, deep)


ROW_KEYS = {
    "number": int,
    "fault": str,
    "place": str,
    "inject": str,
    "reaction": str,
    "keep": str,
}
OPTIONAL = {"cycles": int, "limit_ms": float, "lock_step": list, "tests": list, "not_run": str}


def _row(entry: Any, where: str) -> Row:
    table = _table(entry, where, ROW_KEYS, OPTIONAL)
    where = f"{where} ({table['fault']})"
    lock_step = [_lock_step(run, where) for run in table.get("lock_step", [])]
    tests = [_test(run, where) for run in table.get("tests", [])]
    not_run = table.get("not_run", "")
    if bool(lock_step or tests) == bool(not_run):
        raise InputError(f"{where}: expected either runs or not_run with the reason")
    longest = max((run.cycles for run in lock_step), default=0)
    if "cycles" in table and longest > table["cycles"]:
        raise InputError(f"{where}: a lock_step has {longest} cycles, more than the row's")
    return Row(
        **{key: table[key] for key in ROW_KEYS},
        cycles=table.get("cycles"),
        limit_ms=table.get("limit_ms"),
        lock_step=lock_step,
        tests=tests,
        not_run=not_run,
    )


def _lock_step(entry: Any, where: str) -> LockStepRun:
    kinds = {field.name: _kind(field.type) for field in fields(LockStepRun)}
    required = {key: kinds.pop(key) for key in ("fault", "reaction")}
    table = _table(entry, f"{where}: lock_step", required, kinds)
    run = LockStepRun(**table)
    where = f"{where}: lock_step '{run.fault}'"
    if run.reaction not in REACTIONS:
        raise InputError(f"{where}: reaction '{run.reaction}' is none of {', '.join(REACTIONS)}")
    leaves_on = run.reaction in ("FALLBACK", "DAMP", "FAULT")
    if leaves_on != bool(run.cycles):
        raise InputError(f"{where}: cycles are for {', '.join(REACTIONS[:3])}, and needed there")
    if (run.reaction in ("kept still", "stopped")) != bool(run.moved_rad):
        raise InputError(f"{where}: moved_rad is for 'kept still' and 'stopped', and needed there")
    if run.moved_on_rad and run.reaction in ("bridged", "refused", "kept still"):
        raise InputError(f"{where}: moved_on_rad is for drives that leave ON")
    return run


def _test(entry: Any, where: str) -> NamedTest:
    where = f"{where}: tests"
    table = _table(entry, where, {"test": str, "how": str}, {"known_failing": str})
    if table["how"] not in TESTS:
        raise InputError(f"{where}: how '{table['how']}' is none of {', '.join(TESTS)}")
    if "::" not in table["test"]:
        raise InputError(f"{where}: '{table['test']}' is no FILE::NAME")
    return NamedTest(**table)


def _kind(annotation: Any) -> type:
    kind: type = {"str": str, "int": int, "float": float}.get(annotation, annotation)
    return kind


def _table(
    entry: Any, where: str, required: dict[str, type], optional: dict[str, type] | None = None
) -> dict[str, Any]:
    """A mapping with these keys and no others, of these types."""
    optional = optional or {}
    if not isinstance(entry, dict):
        raise InputError(f"{where}: expected a table of keys and values")
    kinds = required | optional
    unknown = [str(key) for key in entry if key not in kinds]
    if unknown:
        raise InputError(f"{where}: unknown key '{unknown[0]}'; there are {', '.join(kinds)}")
    missing = [key for key in required if key not in entry]
    if missing:
        raise InputError(f"{where}: '{missing[0]}' is missing")
    for key, value in entry.items():
        accepted = (int, float) if kinds[key] is float else kinds[key]
        if not isinstance(value, accepted) or isinstance(value, bool):
            raise InputError(f"{where}: {key} is {value!r}, expected {kinds[key].__name__}")
        if isinstance(value, int | float) and not 0 < value < 1e9:
            raise InputError(f"{where}: {key} is {value}, expected more than 0")
    return entry
