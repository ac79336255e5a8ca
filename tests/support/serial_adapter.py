"""A CAN adapter on a serial line, as its maker describes it: a pseudo-terminal on one side, a
virtual bus on the other.
"""

from __future__ import annotations

import os
import pty
import select
import struct
import threading
import tty
from collections import deque
from pathlib import Path

import can
from local_drive import multicast_group

PORT = 43113


class Slcan:
    """LAWICEL's lines. Sends frames only once its channel is open."""

    def __init__(self) -> None:
        self.rest = b""
        self.heard: list[bytes] = []
        self.open = False

    def take(self, data: bytes) -> tuple[list[can.Message], bytes]:
        """Frames for the bus, and the answers."""
        *lines, self.rest = (self.rest + data).split(b"\r")
        frames, answers = [], b""
        for line in lines:
            kind = line[:1]
            if kind in (b"t", b"T"):
                digits = 3 if kind == b"t" else 8
                number, data = (
                    int(line[1 : 1 + digits], 16),
                    bytes.fromhex(line[2 + digits :].decode()),
                )
                assert len(data) == int(line[1 + digits : 2 + digits])
                frames.append(
                    can.Message(arbitration_id=number, is_extended_id=kind == b"T", data=data)
                )
                answers += b"z\r" if kind == b"t" else b"Z\r"
                continue
            self.heard.append(line)
            closed = line == b"C" and not self.open
            self.open = line == b"O" or (self.open and line != b"C")
            answers += b"\a" if closed else b"\r"
        return frames if self.open else [], answers

    def write(self, frame: can.Message) -> bytes:
        form = (
            f"T{frame.arbitration_id:08X}"
            if frame.is_extended_id
            else f"t{frame.arbitration_id:03X}"
        )
        return f"{form}{frame.dlc}{frame.data.hex()}\r".encode()


class Damiao:
    """Records; each frame that was sent is confirmed."""

    def __init__(self) -> None:
        self.rest = b""

    def take(self, data: bytes) -> tuple[list[can.Message], bytes]:
        self.rest += data
        frames, answers = [], b""
        while len(self.rest) >= 30:
            record, self.rest = self.rest[:30], self.rest[30:]
            assert record[:4] == b"\x55\xaa\x1e\x03", record.hex()
            frame = can.Message(
                arbitration_id=struct.unpack_from("<I", record, 13)[0],
                is_extended_id=bool(record[12]),
                data=record[21 : 21 + record[18]],
            )
            frames.append(frame)
            answers += self._record(0x12, frame)
        return frames, answers

    def write(self, frame: can.Message) -> bytes:
        return self._record(0x11, frame)

    @staticmethod
    def _record(what: int, frame: can.Message) -> bytes:
        flags = frame.dlc | (0x40 if frame.is_extended_id else 0)
        data = bytes(frame.data).ljust(8, b"\0")
        return struct.pack("<BBBI8sB", 0xAA, what, flags, frame.arbitration_id, data, 0x55)


KINDS = {"slcan": Slcan, "dmserial": Damiao}


class SerialAdapter:
    """Context manager. `link`: a name that stays when it is unplugged and comes back; `address`:
    for `can:`. What reaches it is handed over in pieces of 7 bytes, to cut frames.
    """

    def __init__(self, kind: str, bus: str, link: Path) -> None:
        self._make, self.link = KINDS[kind], link
        self.address = f"{kind}:{link}"
        self._bus = can.Bus(
            interface="udp_multicast", channel=multicast_group(bus), port=PORT, hop_limit=0
        )
        self._end = threading.Event()
        self._own: deque[tuple[int, bytes]] = deque(maxlen=64)
        self.plug_in()

    def plug_in(self) -> None:
        self._master, slave = pty.openpty()
        tty.setraw(slave)
        self.link.symlink_to(os.ttyname(slave))
        os.close(slave)
        self._end.clear()
        self._codec = self._make()
        self._threads = [threading.Thread(target=work) for work in (self._out, self._in)]
        for thread in self._threads:
            thread.start()

    def unplug(self) -> None:
        self.link.unlink()
        self._end.set()
        for thread in self._threads:
            thread.join()
        os.close(self._master)

    def __enter__(self) -> SerialAdapter:
        return self

    def __exit__(self, *_error: object) -> None:
        if not self._end.is_set():
            self.unplug()
        self._bus.shutdown()

    def _out(self) -> None:
        while not self._end.is_set():
            if not select.select([self._master], [], [], 0.05)[0]:
                continue
            try:
                frames, answers = self._codec.take(os.read(self._master, 7))
            except OSError:  # nobody has opened the other end yet, or any more
                self._end.wait(0.01)
                continue
            for frame in frames:
                self._own.append(_content(frame))
                self._bus.send(frame)
            self._answer(answers)

    def _in(self) -> None:
        while not self._end.is_set():
            frame = self._bus.recv(0.05)
            if frame is None:
                continue
            if _content(frame) in self._own:  # the group has our own frames, too
                self._own.remove(_content(frame))
            else:
                self._answer(self._codec.write(frame))

    def _answer(self, data: bytes) -> None:
        if data and select.select([], [self._master], [], 0.0)[1]:
            os.write(self._master, data)


def _content(frame: can.Message) -> tuple[int, bytes]:
    return frame.arbitration_id, bytes(frame.data)
