"""Logs made from formulas, so that every test knows what has to come out."""

from pathlib import Path

import numpy as np

from limber import messages
from limber.log.event_file import HEADER, SYNC

RATE_HZ = 200


def records(type_name: str, count: int, **fields) -> np.ndarray:
    """`count` messages of a type, numbered from 0; other fields as given, the rest zero."""
    made = np.zeros(count, messages.dtype_of(type_name))
    made[messages.FINGERPRINT] = messages.fingerprint_of(type_name)
    made[made.dtype.names[1]] = np.arange(count)
    for name, values in fields.items():
        made[name] = values
    return made


def event_bytes(channel: str, data: bytes, number: int = 0, stamp_us: int = 0) -> bytes:
    header = HEADER.pack(SYNC, number, stamp_us, len(channel), len(data))
    return header + channel.encode() + data


def write_log(path: Path, channels: dict[str, np.ndarray]) -> Path:
    """All channels' messages in order of their time."""
    events = [
        (int(record["time_ns"]), channel, record.tobytes())
        for channel, rows in channels.items()
        for record in rows
    ]
    events.sort(key=lambda event: event[0])
    with open(path, "wb") as file:
        for number, (time_ns, channel, data) in enumerate(events):
            file.write(event_bytes(channel, data, number, time_ns // 1000))
    return path
