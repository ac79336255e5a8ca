"""MCAP, for Foxglove and PlotJuggler; the story of the run beside it, for Foxglove's Log panel."""

from collections.abc import Sequence
from heapq import merge
from pathlib import Path

from mcap.writer import CompressionType, Writer

from limber import __version__
from limber.log.convert.foxglove_messages import Message, Messages, time_of
from limber.log.convert.windows import Batch
from limber.log.events import Event

LOG_TOPIC = "/events"
INFO, ERROR = 2, 4  # levels of foxglove.Log


class McapFile:
    def __init__(self, path: Path, joints: tuple[str, ...]) -> None:
        self._messages = Messages(joints)
        self._numbers: dict[str, int] = {}
        self._file = open(path, "wb")  # noqa: SIM115
        self._writer = Writer(self._file, chunk_size=1 << 20, compression=CompressionType.ZSTD)
        self._writer.start(library=f"limber {__version__}")

    def begin(self, story: Sequence[Event], arm_time_zero_us: int) -> None:
        for event in story:
            stamp_us = arm_time_zero_us + round(event.time_s * 1e6)
            level = ERROR if event.bad else INFO
            content = {"level": level, "name": event.who, "message": event.text}
            content |= {"timestamp": time_of(stamp_us), "file": "", "line": 0}
            self._add(self._messages.json(LOG_TOPIC, "foxglove.Log", content, stamp_us))

    def write(self, window: list[Batch]) -> None:
        made = self._messages
        streams = [made.encode(batch) for batch in window]
        poses = [s for b in window if b.channel == "CONTROLLER_STATUS" for s in made.poses(b)]
        for message in merge(*(sorted(s, key=_stamp) for s in [*streams, *poses]), key=_stamp):
            self._add(message)

    def close(self) -> None:
        self._writer.finish()
        self._file.close()

    def _add(self, message: Message) -> None:
        stamp_us, topic, data = message
        if topic.name not in self._numbers:
            schema = (topic.schema, topic.schema_encoding, topic.described)
            number = self._writer.register_schema(*schema)
            self._numbers[topic.name] = self._writer.register_channel(
                topic.name, topic.encoding, number
            )
        number, time_ns = self._numbers[topic.name], stamp_us * 1000
        self._writer.add_message(number, log_time=time_ns, data=data, publish_time=time_ns)


def _stamp(message: Message) -> int:
    return message[0]
