"""Protobuf without a call a message: every field is written with a fixed width, so that all
messages of a type have their tags and lengths at the same places, and a thousand of them are one
numpy array.

Wire format: https://protobuf.dev/programming-guides/encoding/
"""

from dataclasses import dataclass, field

import numpy as np
from google.protobuf import descriptor_pb2

from limber import messages
from limber.log.convert.columns import Column

_Field = descriptor_pb2.FieldDescriptorProto
# numpy kind and size -> protobuf type, its wire type, what is stored
_FIXED = {
    "f8": (_Field.TYPE_DOUBLE, 1, "<f8"),
    "f4": (_Field.TYPE_FLOAT, 5, "<f4"),
    "i8": (_Field.TYPE_SFIXED64, 1, "<i8"),
    "i4": (_Field.TYPE_SFIXED32, 5, "<i4"),
    "i2": (_Field.TYPE_SFIXED32, 5, "<i4"),
    "i1": (_Field.TYPE_SFIXED32, 5, "<i4"),
}
_ENUM = (_Field.TYPE_ENUM, 0, "u1")
_MESSAGE_WIRE_TYPE = 2
UNKNOWN_WORD = 127  # a number that stands for no word; the longest that takes one byte


@dataclass
class _Node:
    """A message: its fields are columns or messages."""

    columns: dict[str, Column] = field(default_factory=dict)
    nodes: dict[str, "_Node"] = field(default_factory=dict)


class Layout:
    """How messages of a type are encoded. `schema`: a serialised FileDescriptorSet."""

    def __init__(self, type_name: str, columns: list[Column]) -> None:
        self.name = f"limber.{type_name}"
        self._kinds = messages.native_dtype_of(type_name)
        self._places: list[tuple[Column, int, str]] = []
        tree = _tree(columns)
        self._template = np.frombuffer(self._bytes(tree, 0), np.uint8)
        files = descriptor_pb2.FileDescriptorSet()
        file = files.file.add(name=f"{type_name}.proto", package="limber", syntax="proto3")
        self._describe(file.message_type.add(name=type_name), tree)
        self.schema = files.SerializeToString()

    def encode(self, records: np.ndarray) -> list[bytes]:
        """One message of bytes a record."""
        rows = np.tile(self._template, (len(records), 1))
        size = rows.shape[1]
        for column, start, kind in self._places:
            place: tuple[slice | int, ...] = (slice(None), *column.index)
            values = records[column.field][place]
            if column.words:
                values = np.where((values >= 0) & (values < UNKNOWN_WORD), values, UNKNOWN_WORD)
            stored = np.ascontiguousarray(values, dtype=kind)
            width = stored.itemsize
            rows[:, start : start + width] = stored.view(np.uint8).reshape(-1, width)
        data = rows.tobytes()
        return [data[i : i + size] for i in range(0, len(data), size)]

    def _kind(self, column: Column) -> "tuple[_Field.Type.ValueType, int, str]":
        base = self._kinds[column.field].base
        return _ENUM if column.words else _FIXED[f"{base.kind}{base.itemsize}"]

    def _bytes(self, node: _Node, start: int) -> bytes:
        """A message with zeros for values; notes where they go. `start`: where it begins."""
        made = b""
        for number, _, part in _fields(node):
            if isinstance(part, Column):
                _, wire_type, kind = self._kind(part)
                made += _varint(number << 3 | wire_type)
                self._places.append((part, start + len(made), kind))
                made += bytes(np.dtype(kind).itemsize)
            else:
                made += _varint(number << 3 | _MESSAGE_WIRE_TYPE) + _varint(self._size(part))
                made += self._bytes(part, start + len(made))
        return made

    def _size(self, node: _Node) -> int:
        size = 0
        for number, _, part in _fields(node):
            size += len(_varint(number << 3))
            if isinstance(part, Column):
                size += np.dtype(self._kind(part)[2]).itemsize
            else:
                inner = self._size(part)
                size += len(_varint(inner)) + inner
        return size

    def _describe(self, message: descriptor_pb2.DescriptorProto, node: _Node) -> None:
        for number, name, part in _fields(node):
            entry = message.field.add(name=name, number=number, label=_Field.LABEL_OPTIONAL)
            entry.json_name = name  # rot_y and rotY would both become rotY
            if isinstance(part, Column):
                entry.type = self._kind(part)[0]
                if part.words:
                    entry.type_name = _add_enum(message, name, part.words)
            else:
                entry.type, entry.type_name = _Field.TYPE_MESSAGE, f"{name}_t"
                self._describe(message.nested_type.add(name=f"{name}_t"), part)


def _fields(node: _Node) -> list[tuple[int, str, Column | _Node]]:
    parts: list[tuple[str, Column | _Node]] = [*node.columns.items(), *node.nodes.items()]
    return [(number, name, part) for number, (name, part) in enumerate(parts, 1)]


def _tree(columns: list[Column]) -> _Node:
    root = _Node()
    for column in columns:
        node = root
        for name in column.path[:-1]:
            node = node.nodes.setdefault(name, _Node())
        node.columns[column.path[-1]] = column
    return root


def _add_enum(message: descriptor_pb2.DescriptorProto, name: str, words: tuple[str, str]) -> str:
    made = message.enum_type.add(name=f"{name}_words")
    type_name, prefix = words
    for number, word in sorted(messages.constants(type_name, prefix).items()):
        made.value.add(name=f"{prefix}{word}", number=number)
    name_there: str = made.name
    return name_there


def _varint(value: int) -> bytes:
    made = b""
    while value > 0x7F:
        made += bytes([value & 0x7F | 0x80])
        value >>= 7
    return made + bytes([value])
