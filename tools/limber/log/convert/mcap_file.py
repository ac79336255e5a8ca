"""MCAP, for Foxglove and PlotJuggler: numbers as protobuf, messages with text as JSON.

What Foxglove draws by itself comes beside: the story of the run for its Log panel, the poses of tip
and goal for its 3D panel.
"""

import json
from collections.abc import Iterable, Sequence
from heapq import merge
from pathlib import Path
from typing import Any

import numpy as np
from mcap.writer import CompressionType, Writer

from limber import __version__
from limber.log.convert.columns import as_object, columns
from limber.log.convert.protobuf_layout import Layout
from limber.log.convert.windows import Batch
from limber.log.events import Event

LOG_TOPIC = "/events"
POSES = {"/tip": ("p_BT", "quat_BT"), "/goal": ("p_BD", "quat_BD")}  # of CONTROLLER_STATUS
BASE_FRAME = "base"
INFO, ERROR = 2, 4  # levels of foxglove.Log

Message = tuple[int, int, bytes]  # stamp in µs, channel number of the file, data


class McapFile:
    def __init__(self, path: Path, joints: tuple[str, ...]) -> None:
        self._joints = joints
        self._layouts: dict[str, Layout] = {}
        self._numbers: dict[str, int] = {}
        self._file = open(path, "wb")  # noqa: SIM115
        self._writer = Writer(self._file, chunk_size=1 << 20, compression=CompressionType.ZSTD)
        self._writer.start(library=f"limber {__version__}")

    def begin(self, story: Sequence[Event], arm_time_zero_us: int) -> None:
        for event in story:
            stamp_us = arm_time_zero_us + round(event.time_s * 1e6)
            level = ERROR if event.bad else INFO
            content = {"level": level, "name": event.who, "message": event.text}
            content |= {"timestamp": _time(stamp_us), "file": "", "line": 0}
            self._add(self._json(LOG_TOPIC, "foxglove.Log", content, stamp_us))

    def write(self, window: list[Batch]) -> None:
        streams = [self._encode(batch) for batch in window]
        poses = [s for b in window if b.channel == "CONTROLLER_STATUS" for s in self._poses(b)]
        for message in merge(*(sorted(s, key=_stamp) for s in [*streams, *poses]), key=_stamp):
            self._add(message)

    def close(self) -> None:
        self._writer.finish()
        self._file.close()

    def _add(self, message: Message) -> None:
        stamp_us, number, data = message
        time_ns = stamp_us * 1000
        self._writer.add_message(number, log_time=time_ns, data=data, publish_time=time_ns)

    def _encode(self, batch: Batch) -> Iterable[Message]:
        topic = f"/{batch.channel}"
        stamps = batch.stamps_us.tolist()
        if not isinstance(batch.messages, np.ndarray):
            schema = f"limber.{batch.type_name}"
            for stamp_us, message in zip(stamps, batch.messages, strict=True):
                yield self._json(topic, schema, as_object(message, self._joints), stamp_us)
            return
        layout = self._layout(batch.type_name)
        number = self._channel(topic, layout.name, "protobuf", "protobuf", layout.schema)
        for stamp_us, data in zip(stamps, layout.encode(batch.messages), strict=True):
            yield stamp_us, number, data

    def _layout(self, type_name: str) -> Layout:
        if type_name not in self._layouts:
            self._layouts[type_name] = Layout(type_name, columns(type_name, self._joints))
        return self._layouts[type_name]

    def _poses(self, batch: Batch) -> list[list[Message]]:
        assert isinstance(batch.messages, np.ndarray)
        made = []
        for topic, (position, quaternion) in POSES.items():
            places = batch.messages[position].tolist()
            turns = batch.messages[quaternion].tolist()
            rows = zip(batch.stamps_us.tolist(), places, turns, strict=True)
            made.append([self._pose(topic, *row) for row in rows])
        return made

    def _pose(self, topic: str, stamp_us: int, p: list[float], quat: list[float]) -> Message:
        w, x, y, z = quat
        pose = {"position": _xyz(*p), "orientation": {**_xyz(x, y, z), "w": w}}
        content = {"timestamp": _time(stamp_us), "frame_id": BASE_FRAME, "pose": pose}
        return self._json(topic, "foxglove.PoseInFrame", content, stamp_us)

    def _json(self, topic: str, schema: str, content: dict[str, Any], stamp_us: int) -> Message:
        if topic not in self._numbers:
            described = json.dumps(_described(content)).encode()
            self._channel(topic, schema, "json", "jsonschema", described)
        return stamp_us, self._numbers[topic], json.dumps(content).encode()

    def _channel(
        self, topic: str, schema: str, encoding: str, schema_encoding: str, content: bytes
    ) -> int:
        if topic not in self._numbers:
            schema_id = self._writer.register_schema(schema, schema_encoding, content)
            self._numbers[topic] = self._writer.register_channel(topic, encoding, schema_id)
        return self._numbers[topic]


def _stamp(message: Message) -> int:
    return message[0]


def _time(stamp_us: int) -> dict[str, int]:
    seconds, microseconds = divmod(stamp_us, 1_000_000)
    return {"sec": seconds, "nsec": microseconds * 1000}


def _xyz(x: float, y: float, z: float) -> dict[str, float]:
    return {"x": x, "y": y, "z": z}


def _described(value: Any) -> dict[str, Any]:
    """JSON schema of a value."""
    if isinstance(value, dict):
        return {"type": "object", "properties": {k: _described(v) for k, v in value.items()}}
    if isinstance(value, list):
        return {"type": "array", **({"items": _described(value[0])} if value else {})}
    names = {bool: "boolean", int: "integer", float: "number", str: "string"}
    return {"type": names[type(value)]}
