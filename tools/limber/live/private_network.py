"""Makes the loopback of a new network namespace fit for multicast, then becomes a command: as
`ip link set lo up multicast on; ip route add 224.0.0.0/4 dev lo` does, where no `ip` is installed.

A script that needs Python alone: network.py starts it behind `unshare`.
"""

import ctypes
import fcntl
import os
import socket
import struct
import sys

LOOPBACK = b"lo"
# linux/sockios.h, linux/if.h, linux/route.h
SIOCADDRT, SIOCGIFFLAGS, SIOCSIFFLAGS = 0x890B, 0x8913, 0x8914
IFF_UP, IFF_MULTICAST, RTF_UP = 0x1, 0x1000, 0x1
IFREQ = "16sh22x"  # name, flags


class Address(ctypes.Structure):
    """sockaddr_in."""

    _fields_ = (
        ("family", ctypes.c_uint16),
        ("port", ctypes.c_uint16),
        ("address", ctypes.c_uint8 * 4),
        ("rest", ctypes.c_uint8 * 8),
    )


class Route(ctypes.Structure):
    """rtentry."""

    _fields_ = (
        ("pad1", ctypes.c_ulong),
        ("destination", Address),
        ("gateway", Address),
        ("mask", Address),
        ("flags", ctypes.c_ushort),
        ("pad2", ctypes.c_short),
        ("pad3", ctypes.c_ulong),
        ("pad4", ctypes.c_void_p),
        ("metric", ctypes.c_short),
        ("device", ctypes.c_char_p),
        ("mtu", ctypes.c_ulong),
        ("window", ctypes.c_ulong),
        ("round_trip", ctypes.c_ushort),
    )


def address(text: str) -> Address:
    made = Address(family=socket.AF_INET)
    made.address[:] = list(socket.inet_aton(text))
    return made


def set_up() -> None:
    """Raises OSError."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        request = fcntl.ioctl(any_socket, SIOCGIFFLAGS, struct.pack(IFREQ, LOOPBACK, 0))
        flags = struct.unpack(IFREQ, request)[1] | IFF_UP | IFF_MULTICAST
        fcntl.ioctl(any_socket, SIOCSIFFLAGS, struct.pack(IFREQ, LOOPBACK, flags))
        route = Route(
            destination=address("224.0.0.0"),
            gateway=address("0.0.0.0"),
            mask=address("240.0.0.0"),
            flags=RTF_UP,
            device=LOOPBACK,
        )
        fcntl.ioctl(any_socket, SIOCADDRT, bytes(route))


if __name__ == "__main__":
    set_up()
    os.execvp(sys.argv[1], sys.argv[1:])
