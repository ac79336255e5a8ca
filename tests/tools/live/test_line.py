"""What a Line sends, byte by byte, as LCM's protocol for short messages has it."""

import socket
from contextlib import closing

import pytest

from limber.errors import RunError
from limber.live.line import Line, datagrams


def test_the_datagrams():
    with closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as hears:
        hears.bind(("127.0.0.1", 0))
        hears.settimeout(5)
        with closing(Line(f"udpm://127.0.0.1:{hears.getsockname()[1]}?ttl=0")) as line:
            line.publish("MODE_REQUEST", b"\x01\x00\xff")
            line.publish("PUSH", b"")
            first, second = hears.recv(2000), hears.recv(2000)
    assert first == b"LC02" + b"\0\0\0\0" + b"MODE_REQUEST\0" + b"\x01\x00\xff"
    assert second == b"LC02" + b"\0\0\0\x01" + b"PUSH\0"


def test_the_ttl_is_the_addresss_and_none_without():
    for query, ttl in (("", 0), ("?ttl=3", 3)):
        with closing(Line(f"udpm://127.0.0.1:7667{query}")) as line:
            line.publish("PUSH", b"")
            assert line._sender is not None
            assert line._sender.getsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL) == ttl


@pytest.mark.parametrize("url", ["udpm://239.1.2.3:0", "tcpq://x:1", "udpm://239.1.2.3:7?ttl=x"])
def test_another_address_is_refused(url):
    with pytest.raises(RunError, match="expected udpm://GROUP:PORT"):
        Line(url)


@pytest.fixture
def two():
    """A line, and the socket that hears it."""
    with closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as hears:
        hears.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 21)
        hears.bind(("127.0.0.1", 0))
        hears.settimeout(5)
        with closing(Line(f"udpm://127.0.0.1:{hears.getsockname()[1]}?ttl=0")) as line:
            yield line, hears


def test_the_longest_datagram(two):
    line, hears = two
    line.publish("ARM", bytes(65_495))  # with the channel's name 65,499 bytes
    assert hears.recv(70_000) == b"LC02" + bytes(4) + b"ARM\0" + bytes(65_495)


def test_the_fragments_of_a_longer_message(two):
    """70,000 bytes, 1_1170h: 65,483 of them behind "ARM\\0" make a part of 65,487 bytes, and
    4,517 are left; they begin at byte 65,483, FFCBh.
    """
    line, hears = two
    message = bytes(range(250)) * 280
    line.publish("PUSH", b"")
    line.publish("ARM", message)
    hears.recv(2000)
    head = b"LC03" + b"\0\0\0\x01" + b"\x00\x01\x11\x70"
    assert hears.recv(70_000) == (
        head + b"\0\0\0\0" + b"\0\0" + b"\0\x02" + b"ARM\0" + message[:65_483]
    )
    assert hears.recv(70_000) == head + b"\0\0\xff\xcb" + b"\0\x01" + b"\0\x02" + message[65_483:]


@pytest.mark.parametrize("size", [65_496, 65_487 * 2 - 4, 65_487 * 2 - 3, 300_000])
def test_every_byte_is_sent_once(size):
    """Fragments as long as they may be, whatever is left for the last."""
    parts = list(datagrams(7, "ARM", bytes(size)))
    lengths = [len(part) - 20 for part in parts]
    assert sum(lengths) == size + 4 and max(lengths) <= 65_487 and min(lengths) > 0
    assert {part[18:20] for part in parts} == {len(parts).to_bytes(2, "big")}
