"""What a Line sends, byte by byte, as LCM's protocol for short messages has it."""

import socket
from contextlib import closing

import pytest

from limber.errors import RunError
from limber.live.line import Line


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


def test_too_much_for_a_datagram_is_told():
    with (
        closing(Line("udpm://127.0.0.1:7667?ttl=0")) as line,
        pytest.raises(RunError, match="PUSH cannot be sent"),
    ):
        line.publish("PUSH", bytes(70_000))
