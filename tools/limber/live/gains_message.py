"""A gains request by the controller's own table: it changes what it names, all else stays."""

from typing import Any

import numpy as np

from limber.errors import InputError
from limber.live.values import number, numbers, one_of
from limber.messages import message_class
from limber.model.gains_table import law_names, listing

_BLOCKS = {"K_x_translation_N_per_m": 0, "K_x_rotation_Nm_per_rad": 3}


def gains(joints: int, law: str | None, ramp_s: float, **given: Any) -> Any:
    """A compliance_gains_t (SCOPE_NAMED) for an arm of so many joints; values by their keys.

    A number; one number or one a joint; a 6x6 matrix; one or three for a diagonal block of K_x; a
    word of a choice, or True or False; a dict of a map such as period_cycles. Keys of single laws
    are those of `law`, and of all others if none is given.
    """
    found = listing()
    rows = {row["key"]: row for row in found["gains"]}
    own = {row["key"]: row for each in found["laws"] for row in each["parameters"]}
    message = message_class("compliance_gains_t")()
    message.scope = message.SCOPE_NAMED
    message.num_joints = joints
    message.law = "" if law is None else one_of("law", law, law_names())
    message.ramp_s = number("ramp_s", ramp_s, rows["ramp_s"]["low"], rows["ramp_s"]["high"])
    if "K_x" in given and given.keys() & _BLOCKS.keys():
        raise InputError("K_x is the whole matrix; give either it or its diagonal blocks")
    for key, value in given.items():
        one_of("the gain", key, [*rows, *own])
        if key in rows:
            message.named += _put(message, rows[key], value, joints)
        else:
            message.parameters.append(_parameter(own[key], value, joints))
    message.num_named = len(message.named)
    message.num_parameters = len(message.parameters)
    return message


def _put(message: Any, row: dict[str, Any], value: Any, joints: int) -> list[str]:
    """Writes one field; the keys that name it."""
    key, kind = row["key"], row["kind"]
    if kind == "periods":
        return _put_periods(message, row, value)
    if kind == "blocks":
        _put_block(message, row, value)
    elif kind == "tip_matrix":
        setattr(message, key, _tip_matrix(row, value).tolist())
    elif kind == "joints":
        each = _within(row, numbers(key, value, (joints,), one_for_all=True))
        getattr(message, _field(message, key))[:joints] = each.tolist()
    else:
        setattr(message, key, _one(row, value))
    return [key]


def _put_periods(message: Any, row: dict[str, Any], value: Any) -> list[str]:
    if not isinstance(value, dict):
        raise InputError(f"{row['key']}: expected a dict such as {{'inertia': 4}}")
    words = [word["word"] for word in row["words"]]
    for term, cycles in value.items():
        place = words.index(one_of(row["key"], term, words))
        whole = int(number(f"{row['key']}.{term}", cycles, row["low"], row["high"]))
        getattr(message, row["key"])[place] = whole
    return [f"{row['key']}.{term}" for term in value]


def _put_block(message: Any, row: dict[str, Any], value: Any) -> None:
    first = _BLOCKS[row["key"]]
    diagonal = _within(row, numbers(row["key"], value, (3,), one_for_all=True))
    for i in range(3):
        message.K_x[first + i][first + i] = float(diagonal[i])


def _tip_matrix(row: dict[str, Any], value: Any) -> np.ndarray:
    M = _within({**row, "low": -row["high"]}, numbers(row["key"], value, (6, 6)))
    if not np.abs(M - M.T).max() <= 1e-9 * np.abs(M).max():
        raise InputError(f"{row['key']} is not symmetric")
    return M


def _parameter(row: dict[str, Any], value: Any, joints: int) -> Any:
    parameter = message_class("law_parameter_t")()
    parameter.key = row["key"]
    if row["kind"] == "joints":
        each = _within(row, numbers(row["key"], value, (joints,), one_for_all=True))
        parameter.values = each.tolist()
    else:
        parameter.values = [float(_one(row, value))]
    parameter.num_values = len(parameter.values)
    return parameter


def _one(row: dict[str, Any], value: Any) -> float:
    """A number, or the number of a word."""
    if row["kind"] == "number":
        return number(row["key"], value, row["low"], row["high"])
    words = [word["word"] for word in row["words"]]
    word = str(value).lower() if row["kind"] == "switch" else value
    return words.index(one_of(row["key"], word, words))


def _within(row: dict[str, Any], given: np.ndarray) -> np.ndarray:
    if not (np.all(given >= row["low"]) and np.all(given <= row["high"])):
        unit = row.get("unit", "")
        expected = f"{row['low']:g} to {row['high']:g} {unit}".strip()
        raise InputError(f"{row['key']}: {given.tolist()} is out of range; expected {expected}")
    return given


def _field(message: Any, key: str) -> str:
    """Of the message; the key adds a unit to its name."""
    names: list[str] = message.__slots__
    return next(name for name in names if key == name or key.startswith(f"{name}_"))
