"""What the page tells its server: signs of life, sizes, presses, typed numbers; and what
others send there.
"""

import asyncio
import json
import threading
import time

import pytest
from websockets.asyncio.client import connect
from websockets.exceptions import InvalidStatus

from limber.monitor.page_link import LONGEST, MOST_PER_S, PROTOCOL, PageLink


class Socket:
    """Messages of a page that then closes."""

    def __init__(self, *messages) -> None:
        self._messages = list(messages)

    async def __aiter__(self):
        for message in self._messages:
            yield message if isinstance(message, str | bytes) else json.dumps(message)


def say(kind, value=True, viewer=3) -> dict:
    return {"viewer": viewer, "kind": kind, "value": value}


@pytest.fixture
def link():
    return PageLink(threading.RLock())


def test_a_viewer_lives_until_its_page_closes(link):
    assert link.silent_s(3) == float("inf")
    seen = []

    class Page(Socket):
        async def __aiter__(self):
            yield json.dumps(say("alive"))
            seen.append(link.silent_s(3))

    asyncio.run(link.serve(Page()))
    assert seen[0] < 0.2
    assert link.silent_s(3) == float("inf"), "a closed page is dead at once"


def test_signs_of_life_are_of_one_viewer(link):
    link.note_alive(1)
    time.sleep(0.02)
    link.note_alive(2)
    assert link.silent_s(1) - link.silent_s(2) >= 0.015


HOSTILE = [
    "",
    "{",
    "[]",
    "null",
    "1e999",
    b"\x00\xff",
    "[" * 900,
    json.dumps(say("press", "x" * LONGEST)),
    say("nothing"),
    say("press", viewer="0"),
    say("press", viewer=None),
    {"viewer": 1, "kind": ["press"], "value": 1},
    {"kind": "press", "value": 1},
    say("size", {"width": "wide"}),
    say("size", []),
]


@pytest.mark.parametrize("message", HOSTILE, ids=range(len(HOSTILE)))
def test_what_is_no_message_is_dropped_and_counted(link, message):
    taken = []
    link.on("press", lambda viewer, value: taken.append(value))
    link.on("size", lambda viewer, size: int(size["width"]))
    asyncio.run(link.serve(Socket(message, say("press", "hold"))))
    assert link.dropped == 1
    assert taken == ["hold"], "the next message counts"


def test_a_flood_is_cut(link):
    taken = []
    link.on("press", lambda viewer, value: taken.append(value))
    asyncio.run(link.serve(Socket(*[say("press")] * (20 * MOST_PER_S))))
    assert len(taken) <= 2 * MOST_PER_S  # a second may begin in between
    assert link.dropped == 20 * MOST_PER_S - len(taken)


def call(served, origin: str | None, *messages: str) -> str:
    """What became of the handshake; the messages are sent behind it."""

    async def attempt() -> str:
        address = f"ws://127.0.0.1:{served.get_port()}"
        try:
            async with connect(address, origin=origin, subprotocols=[PROTOCOL]) as socket:
                for message in messages:
                    await socket.send(message)
                await socket.ping()
                return socket.subprotocol
        except InvalidStatus as refusal:
            return str(refusal.response.status_code)

    return asyncio.run(attempt())


def test_only_pages_of_this_server_may_tell_it_anything(served):
    taken = []
    served.link.on("press", lambda viewer, value: taken.append(value))
    press = json.dumps(say("press", "active"))
    assert call(served, "http://evil.example", press) == "403"
    assert call(served, f"http://127.0.0.1:{served.get_port() + 1}", press) == "403"
    assert taken == []
    assert call(served, served.url, press) == PROTOCOL
    end = time.monotonic() + 5
    while not taken and time.monotonic() < end:
        time.sleep(0.01)
    assert taken == ["active"]
