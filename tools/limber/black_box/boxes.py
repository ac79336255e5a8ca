"""Black boxes: what the processes kept around a fault (common/black_box), as one LCM event log.

A box is a header of text and a ring of LCM log records, each at a multiple of eight bytes and
numbered. Damaged or overwritten records are left out.
"""

import os
import re
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from limber.errors import InputError
from limber.log.event_file import HEADER, SYNC
from limber.log.event_writer import EventWriter

FORMAT = "limber-black-box/1"
HEADER_BYTES = 4096
ALIGNMENT = 8
MAX_CHANNEL_BYTES = 63
MAX_MESSAGE_BYTES = 1400  # common/decode_message.h
# `copy`: ~2 of the second run of a robot at the same time, and so on
NAME = re.compile(
    r"(?P<when>\d{8}T\d{6})-(?P<program>[a-z]+)-(?P<robot>.+?)(?P<copy>~\d+)?-(?P<code>[^-]+)\.box"
)
TOGETHER_s = 5.0  # boxes of one event


@dataclass(frozen=True)
class Record:
    number: int
    time_us: int  # since the epoch
    channel: str
    data: bytes


@dataclass(frozen=True)
class Box:
    """One process's box."""

    path: Path
    when: datetime
    program: str
    robot: str
    code: str  # such as driver.VELOCITY; `killed`: its process did not end by itself
    copy: str = ""  # of several runs of the robot at the same time


def folder() -> Path:
    """Where the processes keep black boxes: see common/black_box/black_box.h."""
    own = os.environ.get("LIMBER_BLACK_BOXES")
    if own:
        return Path(own)
    state = os.environ.get("XDG_STATE_HOME")
    base = Path(state) if state else Path.home() / ".local" / "state"
    return base / "limber" / "black_boxes"


def kept_boxes() -> list[Box]:
    """All that are kept, the oldest first."""
    found = []
    for path in sorted(folder().glob("*.box")):
        name = NAME.fullmatch(path.name)
        if name is not None:
            when = datetime.strptime(name["when"], "%Y%m%dT%H%M%S").replace(tzinfo=UTC)
            words = name["program"], name["robot"], name["code"], name["copy"] or ""
            found.append(Box(path, when, *words))
    return found


def together(with_it: Box, boxes: list[Box]) -> list[Box]:
    """Those of the same run, about the same time."""
    return [
        box
        for box in boxes
        if (box.robot, box.copy) == (with_it.robot, with_it.copy)
        and abs((box.when - with_it.when).total_seconds()) <= TOGETHER_s
    ]


def read(path: Path, epoch_us: int | None = None) -> list[Record]:
    """The whole records of a box, in the order in which they were written. `epoch_us`: since 1970
    at the start of CLOCK_MONOTONIC, if not as the box has it.
    """
    own_epoch_us, ring = _opened(path)
    records = _records(ring, own_epoch_us if epoch_us is None else epoch_us)
    return sorted(records, key=lambda record: record.number)


def _opened(path: Path) -> tuple[int, bytes]:
    """Its `epoch_us`, and its ring."""
    content = path.read_bytes()
    header, ring = content[:HEADER_BYTES], content[HEADER_BYTES:]
    lines = header.split(b"\0", 1)[0].decode("utf-8", "replace").splitlines()
    if not lines or lines[0] != FORMAT:
        raise InputError(f"{path} is no black box of this version ({FORMAT})")
    entries = dict(line.split(": ", 1) for line in lines[1:] if ": " in line)
    try:
        return int(entries["epoch_minus_monotonic_ns"]) // 1000, ring
    except (KeyError, ValueError) as error:
        raise InputError(f"{path}: its header has no clock") from error


def _records(ring: bytes, epoch_us: int) -> list[Record]:
    found = []
    position = ring.find(SYNC)
    while position != -1:
        record = _record_at(ring, position, epoch_us) if position % ALIGNMENT == 0 else None
        if record is None:
            after = position + 1
        else:
            found.append(record)
            size = HEADER.size + len(record.channel) + len(record.data)
            after = position + -(-size // ALIGNMENT) * ALIGNMENT
        position = ring.find(SYNC, after)
    return found


def _record_at(ring: bytes, position: int, epoch_us: int) -> Record | None:
    if position + HEADER.size > len(ring):
        return None
    _, number, time_us, name_size, size = HEADER.unpack_from(ring, position)
    if not (0 < name_size <= MAX_CHANNEL_BYTES and 0 <= size <= MAX_MESSAGE_BYTES and number >= 0):
        return None
    start = position + HEADER.size
    name, data = ring[start : start + name_size], ring[start + name_size : start + name_size + size]
    if len(name) != name_size or len(data) != size or not name.isascii():
        return None
    return Record(number, epoch_us + time_us, name.decode("ascii"), data)


def write_log(boxes: list[Box], path: Path) -> int:
    """All records of the boxes once, by time, as an LCM event log; returns how many.

    A state that the driver sent and the controller heard is in both boxes: the first one counts.
    All times are by the first box's wall clock, which may have been set before others began.
    """
    seen = set()
    count = 0
    log = EventWriter(path, compress=False)
    epoch_us, _ = _opened(boxes[0].path)
    records = [record for box in boxes for record in read(box.path, epoch_us)]
    for record in sorted(records, key=lambda record: record.time_us):
        if (record.channel, record.data) in seen:
            continue
        seen.add((record.channel, record.data))
        name = record.channel.encode("ascii")
        header = HEADER.pack(SYNC, count, record.time_us, len(name), len(record.data))
        log.write(header + name + record.data)
        count += 1
    log.close()
    return count
