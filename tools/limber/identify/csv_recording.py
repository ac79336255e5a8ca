"""A recording in a text file of numbers, anybody's, with a table of what its columns are.

The table is YAML:
    format: limber-columns/1
    time_s: t                    # name of a column, or its number from 1; or instead rate_hz: 500
    position: q{}                # q1, q2, ... of the joints in order; or a list
    motor_torque: [i1, i2, i3]   # or motor_current; at least one of these or joint_torque
    joint_torque: tau{}          # torque sensors
    motor_position: m{}          # before the spring; without it, position
    scale: {position: 0.01745, motor_torque: [1, -1, 1]}   # to rad, N m, A, s; m and N of sliders
Torques and positions are those of the joint, behind the gear, positive as the URDF turns it; a
motor_current times gear ratio and torque constant of robot.yaml is a motor_torque.
"""

from pathlib import Path
from typing import Any

import numpy as np

from limber.arrays import Floats, Integers
from limber.errors import InputError
from limber.identify.arm import Arm
from limber.identify.recording import LEAST_S, Recording
from limber.yaml_file import read_yaml

FORMAT = "limber-columns/1"
SIGNALS = ("position", "motor_position", "motor_torque", "motor_current", "joint_torque")
SCALED = ("time_s", *SIGNALS)
TIME_UNITS = {"milliseconds": 1e-3, "microseconds": 1e-6, "nanoseconds": 1e-9}
KEYS = ("format", "time_s", "rate_hz", "scale", *SIGNALS)
SLOWEST_HZ, FASTEST_HZ = 20.0, 20_000.0
GAP = 5.0  # usual steps


def read_csv(path: Path, table: Path, arm: Arm) -> list[Recording]:
    """Throws InputError: file, line, column or key, and what is allowed."""
    content = read_yaml(table)
    _check(content, table)
    numbers, names = _numbers(path)
    count = len(arm.joints)
    signals = {
        key: _signal(content, key, numbers, names, count, table)
        for key in SIGNALS
        if key in content
    }
    time_s = _times(content, numbers, names, table)
    rate_hz = 1.0 / float(np.median(np.diff(time_s)))
    if not SLOWEST_HZ <= rate_hz <= FASTEST_HZ:
        raise InputError(
            f"{path}: {rate_hz:.3g} samples a second; {SLOWEST_HZ:g} to {FASTEST_HZ:g} are allowed"
            + _time_unit(rate_hz)
        )
    parts = np.split(np.arange(len(time_s)), np.flatnonzero(np.diff(time_s) > GAP / rate_hz) + 1)
    parts = [rows for rows in parts if np.ptp(time_s[rows]) >= LEAST_S]
    if not parts:
        raise InputError(f"{path}: nowhere {LEAST_S:g} s without a gap")
    return [_recording(time_s[rows], rate_hz, signals, rows, arm) for rows in parts]


def _check(content: dict[str, Any], table: Path) -> None:
    if content.get("format") != FORMAT:
        raise InputError(f"{table}: format is '{content.get('format')}'; it has to be {FORMAT}")
    for key in content:
        if key not in KEYS:
            raise InputError(f"{table}: {key} is unknown; known are {', '.join(KEYS)}")
    if "position" not in content:
        raise InputError(f"{table}: position is missing: the columns of the joints' positions")
    if not any(key in content for key in SIGNALS[2:]):
        raise InputError(f"{table}: one of {', '.join(SIGNALS[2:])} is needed")
    if "motor_torque" in content and "motor_current" in content:
        raise InputError(f"{table}: motor_torque and motor_current: only one of them")
    if ("time_s" in content) == ("rate_hz" in content):
        raise InputError(f"{table}: either time_s or rate_hz is needed")
    scale = content.get("scale", {})
    if not isinstance(scale, dict) or any(key not in SCALED for key in scale):
        raise InputError(f"{table}: scale: of {', '.join(SCALED)} only, as a mapping")


def _numbers(path: Path) -> tuple[Floats, list[str]]:
    """One row a line, and the names of a header, if there is one."""
    try:
        with open(path, encoding="utf-8-sig") as file:
            first = file.readline().strip()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path} cannot be read as text: {error}") from error
    delimiter = next((mark for mark in (",", ";", "\t") if mark in first), None)
    names = [part.strip().strip('"') for part in first.lstrip("#").split(delimiter)]
    header = not all(_is_number(name) for name in names)
    try:
        numbers = np.loadtxt(
            path, delimiter=delimiter, skiprows=int(header), ndmin=2, encoding="utf-8-sig"
        )
        good = bool(np.isfinite(numbers).all())
    except ValueError:
        good = False
    if not good:
        raise InputError(_first_wrong(path, delimiter, names if header else []))
    if len(numbers) < 2:
        raise InputError(f"{path} holds no samples")
    return numbers, names if header else []


def _first_wrong(path: Path, delimiter: str | None, names: list[str]) -> str:
    """Place of the first cell that is no finite number, or of the first line of other length."""
    width = len(names)
    with open(path, encoding="utf-8-sig") as file:
        for line, text in enumerate(file, 1):
            cells = [cell.strip() for cell in text.split("#")[0].rstrip("\r\n").split(delimiter)]
            if (line == 1 and names) or not any(cells):
                continue
            width = width or len(cells)
            for column, cell in enumerate(cells[:width], 1):
                if not _is_number(cell):
                    name = f" of {names[column - 1]}" if names else ""
                    where = f"{path}, line {line}, column {column}"
                    return f"{where}: {_why(cells, cell, line, name)}"
            if len(cells) != width:
                return f"{path}, line {line}: {len(cells)} columns, {width} before"
    return f"{path} cannot be read as numbers"


def _why(cells: list[str], cell: str, line: int, name: str) -> str:
    if not cell:
        return f"not a finite number: the cell{name} is empty; leave such lines out, or fill them"
    hint = ""
    if _is_number(cell.replace(",", ".", 1)):
        hint = "; write a decimal point"
    elif line == 2 and not any(_is_number(each) for each in cells):
        hint = "; take the line of units out, `scale` of the table of columns turns them"
    return f"not a finite number: '{cell}'{name}{hint}"


def _time_unit(rate_hz: float) -> str:
    for unit, scale in TIME_UNITS.items():
        if SLOWEST_HZ <= rate_hz / scale <= FASTEST_HZ:
            return f"; are the times {unit}? `scale: {{time_s: {scale:.1e}}}` in the table"
    return ""


def _is_number(text: str) -> bool:
    try:
        return bool(np.isfinite(float(text))) and "_" not in text
    except ValueError:
        return False


def _signal(
    content: dict[str, Any],
    key: str,
    numbers: Floats,
    names: list[str],
    count: int,
    table: Path,
) -> Floats:
    columns = content[key]
    if isinstance(columns, str) and "{}" in columns:
        columns = [columns.replace("{}", str(i + 1)) for i in range(count)]
    if not isinstance(columns, list):
        columns = [columns]
    if len(columns) != count:
        raise InputError(f"{table}: {key}: {len(columns)} columns, the arm has {count} joints")
    where = [_column(column, key, numbers, names, table) for column in columns]
    values: Floats = numbers[:, where] * _factors(content, key, count, table)
    return values


def _factors(content: dict[str, Any], key: str, count: int, table: Path) -> Floats:
    scale = content.get("scale", {}).get(key, 1.0)
    try:
        factors = np.broadcast_to(np.asarray(scale, float), count)
    except (TypeError, ValueError) as error:
        numbers = "one number" + (f", or {count}" if count > 1 else "")
        raise InputError(f"{table}: scale: {key}: {numbers}") from error
    if not np.all(np.isfinite(factors) & (factors != 0.0)):
        raise InputError(f"{table}: scale: {key}: {scale}; finite and not 0")
    return factors


def _column(column: Any, key: str, numbers: Floats, names: list[str], table: Path) -> int:
    if isinstance(column, int) and not isinstance(column, bool):
        if not 1 <= column <= numbers.shape[1]:
            raise InputError(f"{table}: {key}: column {column} of {numbers.shape[1]}")
        return column - 1
    if column not in names:
        known = ", ".join(names) if names else "none, the file has no header: give numbers"
        raise InputError(f"{table}: {key}: no column '{column}'; there are: {known}")
    return names.index(column)


def _times(content: dict[str, Any], numbers: Floats, names: list[str], table: Path) -> Floats:
    if "rate_hz" in content:
        rate = content["rate_hz"]
        if not isinstance(rate, int | float) or not SLOWEST_HZ <= rate <= FASTEST_HZ:
            raise InputError(f"{table}: rate_hz: {rate}; {SLOWEST_HZ:g} to {FASTEST_HZ:g}")
        return np.arange(len(numbers)) / rate
    column = _column(content["time_s"], "time_s", numbers, names, table)
    time_s = numbers[:, column] * float(_factors(content, "time_s", 1, table)[0])
    back = np.flatnonzero(np.diff(time_s) <= 0.0)
    if len(back):
        raise InputError(
            f"{table}: time_s: it does not grow from sample {back[0] + 1} to {back[0] + 2}"
        )
    return time_s


def _recording(
    time_s: Floats, rate_hz: float, signals: dict[str, Floats], rows: Integers, arm: Arm
) -> Recording:
    """At even times, between the samples linear."""
    even = np.arange(time_s[0], time_s[-1], 1.0 / rate_hz)

    def at_even(values: Floats) -> Floats:
        return np.column_stack([np.interp(even, time_s, column) for column in values[rows].T])

    found = {key: at_even(values) for key, values in signals.items()}
    count, nothing = len(arm.joints), np.zeros((len(even), len(arm.joints)))
    motor = found.get("motor_torque")
    if "motor_current" in found:
        motor = found["motor_current"] * [joint.torque_constant for joint in arm.joints]
    return Recording(
        rate_hz=rate_hz,
        q=found["position"],
        theta=found.get("motor_position", found["position"]),
        preload=nothing,
        motor=nothing if motor is None else motor,
        tau=found.get("joint_torque", nothing),
        torque_sensor=np.full(count, "joint_torque" in found),
        link_encoder=np.full(count, "motor_position" in found),
        motor_known=motor is not None,
    )
