"""Messages as Foxglove reads them, in a file (MCAP) or live: numbers as protobuf, those that have
text as JSON.

What Foxglove draws by itself comes beside: the poses of tip and goal for its 3D panel.
"""

import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from limber.log.convert.columns import as_object, columns
from limber.log.convert.protobuf_layout import Layout
from limber.log.convert.windows import Batch

POSES = {"/tip": ("p_BT", "quat_BT"), "/goal": ("p_BD", "quat_BD")}  # of CONTROLLER_STATUS
BASE_FRAME = "base"


@dataclass(frozen=True)
class Topic:
    """`schema`: its name; `described`: the schema itself."""

    name: str
    schema: str
    encoding: str
    schema_encoding: str
    described: bytes


Message = tuple[int, Topic, bytes]  # stamp in µs, topic, data


class Messages:
    """`joints`: their names as identifiers (columns)."""

    def __init__(self, joints: tuple[str, ...]) -> None:
        self._joints = joints
        self._layouts: dict[str, Layout] = {}
        self._topics: dict[str, Topic] = {}

    def encode(self, batch: Batch) -> Iterator[Message]:
        """One message a message of the channel."""
        stamps = batch.stamps_us.tolist()
        name = topic_of(batch.channel)
        if not isinstance(batch.messages, np.ndarray):
            schema = f"limber.{batch.type_name}"
            for stamp_us, message in zip(stamps, batch.messages, strict=True):
                yield self.json(name, schema, as_object(message, self._joints), stamp_us)
            return
        layout = self._layout(batch.type_name)
        described = Topic(name, layout.name, "protobuf", "protobuf", layout.schema)
        topic = self._topics.setdefault(name, described)
        for stamp_us, data in zip(stamps, layout.encode(batch.messages), strict=True):
            yield stamp_us, topic, data

    def poses(self, status: Batch) -> list[Iterable[Message]]:
        """Of CONTROLLER_STATUS: one stream a pose."""
        assert isinstance(status.messages, np.ndarray)
        made: list[Iterable[Message]] = []
        for topic, (position, quaternion) in POSES.items():
            places = status.messages[position].tolist()
            turns = status.messages[quaternion].tolist()
            rows = zip(status.stamps_us.tolist(), places, turns, strict=True)
            made.append([self._pose(topic, *row) for row in rows])
        return made

    def json(self, name: str, schema: str, content: dict[str, Any], stamp_us: int) -> Message:
        """A message whose schema is that of the first `content` of its topic."""
        if name not in self._topics:
            described = json.dumps(_described(content)).encode()
            self._topics[name] = Topic(name, schema, "json", "jsonschema", described)
        return stamp_us, self._topics[name], json.dumps(content).encode()

    def _layout(self, type_name: str) -> Layout:
        if type_name not in self._layouts:
            self._layouts[type_name] = Layout(type_name, columns(type_name, self._joints))
        return self._layouts[type_name]

    def _pose(self, topic: str, stamp_us: int, p: list[float], quat: list[float]) -> Message:
        w, x, y, z = quat
        pose = {"position": _xyz(*p), "orientation": {**_xyz(x, y, z), "w": w}}
        content = {"timestamp": time_of(stamp_us), "frame_id": BASE_FRAME, "pose": pose}
        return self.json(topic, "foxglove.PoseInFrame", content, stamp_us)


def topic_of(channel: str) -> str:
    """The topic's name."""
    return f"/{channel}"


def time_of(stamp_us: int) -> dict[str, int]:
    """As the schemas of Foxglove have it."""
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
