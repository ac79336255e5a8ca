"""Frames of a candump log: `(sec.usec) INTERFACE ID#DATA` and `ID##FDATA` for CAN-FD."""

from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from limber.errors import InputError

NS_PER_US = 1000
ERROR_FLAG = 0x20000000


class Frame(NamedTuple):
    time_ns: int
    data: bytes
    fd: bool
    remote: bool


@dataclass(frozen=True)
class Trace:
    """Frames in order of time, by interface and identifier; 29-bit ones have `EXTENDED` added."""

    frames: dict[tuple[str, int], list[Frame]]

    EXTENDED = 1 << 31

    def of(self, interface: str, number: int) -> list[Frame]:
        """Frames of an identifier, in order of time."""
        return self.frames.get((interface, number), [])

    def among(self, interface: str, value: int, mask: int) -> list[tuple[int, Frame]]:
        """Frames of 29-bit identifiers that have `value` where `mask` has ones, and their
        identifiers, in order of time.
        """
        found = [
            (number - self.EXTENDED, frame)
            for (where, number), frames in self.frames.items()
            if where == interface and number >= self.EXTENDED and number & mask == value
            for frame in frames
        ]
        return sorted(found, key=lambda pair: pair[1].time_ns)

    @property
    def span_ns(self) -> tuple[int, int]:
        """Times of the first and last frame."""
        ends = [(frames[0].time_ns, frames[-1].time_ns) for frames in self.frames.values()]
        return (min(first for first, _ in ends), max(last for _, last in ends)) if ends else (0, 0)


def read_trace(path: Path) -> Trace:
    """Raises InputError with the line's number for a line that is none of the format."""
    frames: dict[tuple[str, int], list[Frame]] = defaultdict(list)
    try:
        with open(path, encoding="ascii") as file:
            for number, line in enumerate(file, 1):
                if line.isspace():
                    continue
                try:
                    key, frame = _frame(line)
                except (ValueError, IndexError) as error:
                    raise InputError(
                        f"{path}:{number}: no frame of a candump log: {line.strip()[:60]!r}"
                    ) from error
                if key is not None:
                    frames[key].append(frame)
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path} is no candump log: it is not plain text") from error
    for listed in frames.values():
        listed.sort(key=lambda frame: frame.time_ns)
    return Trace(dict(frames))


def _frame(line: str) -> tuple[tuple[str, int] | None, Frame]:
    stamp, interface, text = line.split()[:3]
    if stamp[0] != "(" or stamp[-1] != ")":
        raise ValueError(stamp)
    seconds, _, fraction = stamp[1:-1].partition(".")
    time_ns = int(seconds) * 10**9 + int(fraction.ljust(9, "0")[:9] or 0)
    digits, mark, rest = text.partition("#")
    if mark != "#" or len(digits) not in (3, 8):
        raise ValueError(text)
    number = int(digits, 16)
    fd = rest.startswith("#")
    remote = rest[:1] in ("R", "r")
    data = b"" if remote else bytes.fromhex(rest[2:] if fd else rest.replace(".", ""))
    frame = Frame(time_ns, data, fd, remote)
    if len(digits) == 8:
        if number & ERROR_FLAG:
            return None, frame
        number |= Trace.EXTENDED
    return (interface, number), frame
