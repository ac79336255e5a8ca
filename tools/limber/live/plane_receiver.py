"""What is sent on an LCM plane, received in C++ without Python's lock (tools/receiver).

liblcm takes the length of a channel's name from the datagram unchecked, and ends the process at one
without a terminating zero. So nothing that comes from outside reaches it.
"""

import ctypes
import socket
import struct
from functools import cache
from typing import Any

from limber.errors import RunError
from limber.live.network import CURE
from limber.paths import REPAIR, private_library

_HEAD = struct.Struct("=iI")  # number of the channel, size


class PlaneReceiver:
    """Hears `group`:`port` on the interface to which this machine routes it, in a thread of its
    own, from the construction to close(). RunError if there is no multicast route. One thread at a
    time may call it.
    """

    def __init__(self, group: str, port: int) -> None:
        self._receiver: int | None = None
        problem = ctypes.create_string_buffer(1000)
        try:
            address = struct.unpack("=I", socket.inet_aton(group))[0]
        except OSError as error:
            raise RunError(f"LCM address {group}: no multicast group") from error
        self._receiver = _library().limber_receiver_open(address, port, problem, len(problem))
        if self._receiver is None:
            text = problem.value.decode(errors="replace")
            if "no multicast route" in text:
                raise RunError(f"LCM finds no multicast route: {CURE}")
            raise RunError(f"LCM on {group}:{port}: {text}")
        self._numbers: dict[str, int] = {}
        self._channels: list[str] = []

    def hear(self, channel: str) -> None:
        """Messages on `channel` are kept from here on, until forget()."""
        if channel not in self._numbers:
            self._numbers[channel] = len(self._channels)
            self._channels.append(channel)
        self._hear(channel, self._numbers[channel])

    def forget(self, channel: str) -> None:
        self._hear(channel, -1)

    def wait(self, timeout_s: float) -> bool:
        """Until messages wait (True), or so long has passed."""
        return bool(_library().limber_receiver_wait(self._receiver, int(1e9 * max(0.0, timeout_s))))

    def take(self) -> list[tuple[str, bytes]]:
        """(channel, message) of all that waits, in order."""
        start = ctypes.c_void_p()
        size = _library().limber_receiver_take(self._receiver, ctypes.byref(start))
        data = ctypes.string_at(start, size) if size else b""
        found, at = [], 0
        while at < size:
            number, length = _HEAD.unpack_from(data, at)
            at += _HEAD.size + length
            found.append((self._channels[number], data[at - length : at]))
        return found

    def malformed(self) -> int:
        """Datagrams that are no messages of LCM's, and were left out."""
        count: int = _library().limber_receiver_malformed(self._receiver)
        return count

    def close(self) -> None:
        if self._receiver is not None:
            _library().limber_receiver_close(self._receiver)
            self._receiver = None

    def __del__(self) -> None:
        self.close()

    def _hear(self, channel: str, number: int) -> None:
        if not _library().limber_receiver_hear(self._receiver, channel.encode(), number):
            raise MemoryError


@cache
def _library() -> Any:
    path = private_library("liblimber_receiver.so")
    try:
        library = ctypes.CDLL(str(path))
    except OSError as error:
        raise RunError(f"{path} cannot be loaded: {REPAIR} ({error})") from error
    handle, number = ctypes.c_void_p, ctypes.c_int64
    signatures: dict[str, tuple[Any, list[Any]]] = {
        "open": (handle, [ctypes.c_uint32, ctypes.c_uint16, ctypes.c_char_p, ctypes.c_size_t]),
        "close": (None, [handle]),
        "hear": (ctypes.c_int, [handle, ctypes.c_char_p, ctypes.c_int32]),
        "wait": (ctypes.c_int, [handle, number]),
        "take": (ctypes.c_size_t, [handle, ctypes.POINTER(handle)]),
        "malformed": (number, [handle]),
        "dropped": (number, [handle]),
    }
    for name, (result, arguments) in signatures.items():
        function = getattr(library, f"limber_receiver_{name}")
        function.restype, function.argtypes = result, arguments
    return library
