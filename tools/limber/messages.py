"""The channel table, the message types, and numpy views of messages instead of decoding each.

A message on the wire is its type's 8-byte fingerprint followed by its fields, big-endian, in order
of declaration. Types without strings have a fixed size: a thousand messages are one numpy array.
"""

import importlib
import os
import struct
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import groupby
from typing import Any

import numpy as np
import yaml

from limber.errors import RunError
from limber.paths import REPAIR

_SCALARS = {
    "int8_t": "i1",
    "byte": "u1",
    "boolean": "i1",
    "int16_t": ">i2",
    "int32_t": ">i4",
    "int64_t": ">i8",
    "float": ">f4",
    "double": ">f8",
}
FINGERPRINT = "_fingerprint"
IN_CACHE = 200  # messages whose bytes are turned at a time, field by field
SCENARIO_CLIENT = 0x5343454E  # of every request in a timeline
SENDERS = ("controller", "session")  # fields that name a run of a program, the nearer first
CLIENT_WITH_LOCK = 1 << 62  # bit of a client that holds a lock while it lives (client_life.h)
SCRIPT_CLIENT, NUM_SCRIPT_CLIENTS = (
    CLIENT_WITH_LOCK + 0x50590000,
    32,
)  # the first of Python's Arm, and how many
MONITOR_CLIENT = 0x4D4F0000  # of `limber monitor`; its port is added
SEND_CLIENT = 0x48414E44  # of `limber send`
CLIENTS = {
    SCENARIO_CLIENT: "scenario",
    SEND_CLIENT: "limber send",
    MONITOR_CLIENT + 8080: "limber monitor",
    **{SCRIPT_CLIENT + i: "Python" for i in range(NUM_SCRIPT_CLIENTS)},
}


@dataclass(frozen=True)
class Channel:
    type_name: str
    timeout_s: float
    sender: str  # driver, controller, sim or user
    numbered: bool  # seq counts the sender's messages; of requests it only rises


def _types() -> Any:
    try:
        return importlib.import_module("limber.lcmtypes")
    except ImportError as error:
        raise RunError(f"the messages are not generated: {REPAIR}") from error


@cache
def table_file(name: str) -> dict[str, Any]:
    """A table that C++ and Python share, such as channels.yaml; the build copies it here."""
    with open(os.path.join(_types().__path__[0], name), encoding="utf-8") as file:
        table: dict[str, Any] = yaml.safe_load(file)
        return table


def _table() -> dict[str, Any]:
    return table_file("channels.yaml")


@cache
def channels() -> dict[str, Channel]:
    """Channels of the user plane by name: those of a log and of `limber watch`."""
    return {
        row.get("name", key): Channel(
            row["type"], row["timeout_s"], row["from"], row["rate"] != "event"
        )
        for key, row in _table()["channels"].items()
        if row["plane"] == "user"
    }


def plane_url(plane: str) -> str:
    """The channel table's address of a plane: `arm` or `user`."""
    url: str = _table()["planes"][plane]
    return url


def user_plane_url() -> str:
    """$LCM_DEFAULT_URL or the channel table's address, with a large receive buffer."""
    url = os.environ.get("LCM_DEFAULT_URL") or plane_url("user")
    return url + ("&" if "?" in url else "?") + "recv_buf_size=2097152"


def message_class(type_name: str) -> Any:
    return getattr(_types(), type_name)


def decode(type_name: str, data: bytes) -> Any:
    """The message, if `data` is exactly one of this type and version; else ValueError.

    The generated reader takes cut strings, lists of negative length, and bytes behind the end.
    """
    cls = message_class(type_name)
    try:
        message = cls.decode(data)
        again = message.encode()
    except (struct.error, IndexError, OverflowError) as error:
        raise ValueError(f"not a {type_name}: {error}") from error
    counts = {size for shape in cls.__dimensions__ for size in shape or () if isinstance(size, str)}
    if again != data or any(getattr(message, count) < 0 for count in counts):
        raise ValueError(f"not a {type_name}: lengths that cannot be")
    return message


def constants(type_name: str, prefix: str) -> dict[int, str]:
    """Value -> name of a message's constants: constants("joint_state_t", "DRIVE_")[3] == "ON"."""
    members = vars(message_class(type_name)).items()
    return {value: name.removeprefix(prefix) for name, value in members if name.startswith(prefix)}


def bit_names(type_name: str, prefix: str, bits: int) -> list[str]:
    return [name for bit, name in constants(type_name, prefix).items() if bits & bit]


@cache
def dtype_of(type_name: str) -> np.dtype | None:
    """Wire layout of a type as a numpy dtype; None if it has strings (no fixed size)."""
    cls = message_class(type_name)
    fields: list[tuple] = [(FINGERPRINT, ">u8")]
    for name, kind, shape in zip(cls.__slots__, cls.__typenames__, cls.__dimensions__, strict=True):
        if kind not in _SCALARS or any(isinstance(size, str) for size in shape or ()):
            return None
        fields.append((name, _SCALARS[kind], tuple(shape or ())))
    return np.dtype(fields)


@cache
def fingerprint_of(type_name: str) -> int:
    return int.from_bytes(message_class(type_name)().encode()[:8], "big")


@cache
def native_dtype_of(type_name: str) -> np.dtype:
    wire = dtype_of(type_name)
    assert wire is not None and wire.names is not None
    return np.dtype([(name, wire[name].newbyteorder("=")) for name in wire.names])


@cache
def _runs_of(type_name: str) -> np.dtype:
    """The wire layout with neighbours of one size as one field: numpy turns field by field."""
    wire = dtype_of(type_name)
    assert wire is not None and wire.names is not None
    runs = groupby((wire[name] for name in wire.names), key=lambda kind: kind.base.itemsize)
    counts = [(size, sum(field.itemsize for field in run) // size) for size, run in runs]
    return np.dtype([(f"run{i}", f"u{size}", (n,)) for i, (size, n) in enumerate(counts)])


def view(type_name: str, data: bytes) -> np.void:
    """One message as a numpy record, in the machine's byte order."""
    wire = dtype_of(type_name)
    if wire is None or len(data) != wire.itemsize:
        raise ValueError(f"not a {type_name}")
    record: np.void = views(type_name, [data])[0]
    if int(record[FINGERPRINT]) != fingerprint_of(type_name):
        raise ValueError(f"not a {type_name} of this version")
    return record


def views(type_name: str, parts: list[bytes]) -> np.ndarray:
    """Messages of one type as records, in the machine's byte order; all must be of this version."""
    if dtype_of(type_name) is None:
        raise ValueError(f"{type_name} has no fixed size")
    return turned(type_name, bytearray().join(parts))


def turned(type_name: str, data: bytearray | np.ndarray) -> np.ndarray:
    """Messages of one type that follow one another, as records in the machine's byte order: of the
    same memory, in which their bytes are turned round.
    """
    records = np.frombuffer(data, _runs_of(type_name))
    if sys.byteorder == "little":
        for at in range(0, len(records), IN_CACHE):
            records[at : at + IN_CACHE].byteswap(inplace=True)
    return records.view(native_dtype_of(type_name))


HAND = "hand"  # the driver's joint behind the last one of the arm, if there is a hand


def joint_name(names: Sequence[str], index: int) -> str:
    """Of an index of JOINT_STATE or of a fault in it; without names by its number from 1."""
    if index < len(names):
        return names[index]
    return HAND if names and index == len(names) else f"joint {index + 1}"


def driven_joints(state: np.void) -> int:
    """Of a JOINT_STATE: the joints, and the hand if there is one."""
    joints, flags = int(state["num_joints"]), state["joint_flags"]
    flag = message_class("joint_state_t").JOINT_HAND
    return joints + int(joints < len(flags) and int(flags[joints]) & flag != 0)
