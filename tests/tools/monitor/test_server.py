"""Who may talk to the page's server, and when what they did is taken."""

import asyncio
import json
import time
import urllib.request

import pytest
import viser
from viser._messages import GuiUpdateMessage
from websockets.asyncio.client import connect
from websockets.exceptions import InvalidStatus

from limber.errors import RunError
from limber.monitor import server
from limber.monitor.page_link import PROTOCOL


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


def typed_by_a_page(served, slider) -> None:
    async def send() -> None:
        address = f"ws://127.0.0.1:{served.get_port()}"
        async with connect(address, subprotocols=[PROTOCOL]) as socket:
            await socket.send(json.dumps({"viewer": 0, "kind": "typed", "value": 7}))

    asyncio.run(send())


def moved_on_a_page(served, slider) -> None:
    interface = served.gui._websock_interface
    update = interface._handle_incoming_message(
        0, GuiUpdateMessage(slider._impl.uuid, {"value": 7.0})
    )
    asyncio.run_coroutine_threadsafe(update, interface._broadcast_buffer.event_loop)


@pytest.mark.parametrize("act", [typed_by_a_page, moved_on_a_page])
def test_what_a_viewer_does_waits_for_the_drawing_of_what_it_changes(served, act):
    slider = served.gui.add_slider("K", 0.0, 10.0, 1.0, 3.0)
    served.link.on("typed", lambda _viewer, value: setattr(slider, "value", value))
    with served.turn:
        act(served, slider)
        time.sleep(0.2)
        assert slider.value == 3.0, "it is not changed while it is drawn"
    for _ in range(200):
        if slider.value == 7.0:
            return
        time.sleep(0.05)
    raise AssertionError("what was done is lost")
