"""Who may talk to the page's server."""

import asyncio
import urllib.request

import pytest
import viser
from websockets.asyncio.client import connect
from websockets.exceptions import InvalidStatus

from limber.errors import RunError
from limber.monitor import server


def handshake(served: server.Server, origin: str | None) -> str:
    """The protocol that was agreed on, or the HTTP status of the refusal."""

    async def attempt() -> str:
        address = f"ws://127.0.0.1:{served.get_port()}"
        protocol = f"viser-v{viser.__version__}"
        try:
            async with connect(address, origin=origin, subprotocols=[protocol]) as socket:
                return socket.subprotocol
        except InvalidStatus as refusal:
            return str(refusal.response.status_code)

    return asyncio.run(attempt())


def test_only_pages_of_this_server_may_connect(served):
    port = served.get_port()
    assert handshake(served, f"http://127.0.0.1:{port}").startswith("viser")
    assert handshake(served, f"http://localhost:{port}").startswith("viser")
    assert handshake(served, None).startswith("viser"), "a program, not a browser"
    for stranger in ("http://evil.example", f"http://evil.example:{port}", "null"):
        assert handshake(served, stranger) == "403"
    assert handshake(served, f"http://127.0.0.1:{port + 1}") == "403", "another local page"


def test_the_browser_may_load_nothing_from_elsewhere_and_frame_nothing(served):
    with urllib.request.urlopen(served.url) as answer:
        policy = answer.headers["Content-Security-Policy"]
        assert answer.headers["X-Frame-Options"] == "DENY"
    assert "frame-ancestors 'none'" in policy
    assert "default-src 'self'" in policy
    port = served.get_port()
    named = {word.rstrip(";") for word in policy.split() if "://" in word}
    assert named == {f"ws://127.0.0.1:{port}", f"ws://localhost:{port}"}


def test_loopback_only_and_no_way_to_the_internet(served):
    assert served.get_host() == "127.0.0.1"
    assert served.request_share_url() is None


def test_a_taken_port_gives_the_next_one(served):
    second = server.start(served.get_port())
    try:
        assert second.get_port() > served.get_port()
        assert handshake(second, second.url).startswith("viser"), "its own port is its origin"
        assert handshake(second, served.url) == "403"
    finally:
        second.close()


def test_ports_that_do_not_exist():
    with pytest.raises(RunError, match="65536"):
        server.start(65536)
