"""Twenty viewers, some that do not read, and whoever else connects: the page loses no message, and
ends as it should.
"""

import os
import signal
import socket
import subprocess
import sys
import time
from contextlib import ExitStack

import pytest
import viser
from many_viewers import viewers
from processes import started
from websockets.exceptions import WebSocketException
from websockets.sync.client import connect

import numbered_messages
from browser_page import ROBOT, free_port
from stack import ROOT

VIEWERS = 20
SECONDS = 15.0


@pytest.fixture
def publisher():
    with started([sys.executable, numbered_messages.__file__]) as process:
        yield process
        process.terminate()


def rss_mb(process: subprocess.Popen) -> float:
    with open(f"/proc/{process.pid}/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


def hostile(port: int, protocol: str | None, *messages: bytes | str) -> None:
    """Sends and reads nothing."""
    protocols = None if protocol is None else [protocol]
    try:
        with connect(f"ws://127.0.0.1:{port}", subprotocols=protocols, max_size=None) as connection:
            for message in messages:
                connection.send(message)
            time.sleep(0.1)
    except (WebSocketException, OSError):
        pass  # thrown out


def half_open(port: int) -> list[socket.socket]:
    """Connections that say nothing, half of a request, or half of a frame, and stay."""
    said = [b"", b"GET / HT", b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\n"]
    made = []
    for number in range(90):
        made.append(socket.create_connection(("127.0.0.1", port)))
        made[-1].sendall(said[number % len(said)])
    return made


def test_nothing_is_lost_with_twenty_viewers_and_hostile_ones(publisher):
    port = free_port()
    command = [sys.executable, "-m", "limber", "monitor", "--robot", ROBOT, "--port", str(port)]
    with ExitStack() as ended:
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
        process = subprocess.Popen(command, cwd=ROOT, **pipes)
        ended.callback(process.kill)
        assert "http://" in process.stdout.readline()
        version = f"viser-v{viser.__version__}"
        asleep = [
            ended.enter_context(connect(f"ws://127.0.0.1:{port}", subprotocols=[version]))
            for _ in range(3)
        ]  # they never read
        for connection in half_open(port):
            ended.callback(connection.close)
        looking = ended.enter_context(viewers(port, VIEWERS))
        served_by = time.monotonic() + 60.0
        while min(looking.read) < 3 and time.monotonic() < served_by:
            time.sleep(0.1)
        assert min(looking.read) >= 3, "all of them are served"
        before = rss_mb(process)
        end = time.monotonic() + SECONDS
        while time.monotonic() < end:
            for protocol in (version, "limber-page", "viser-v0.0.1", None):
                hostile(port, protocol, os.urandom(100), "text", b"", os.urandom(100_000))
            hostile(port, "limber-page", *(['{"viewer": 0, "kind": "press", "value": 1}'] * 500))
            hostile(port, version, bytes(10_000_000))
        assert len(asleep) == 3
        assert rss_mb(process) < before + 150, "what nobody reads is not kept for ever"
        process.send_signal(signal.SIGINT)
        output, _ = process.communicate(timeout=60)
    assert process.returncode == 0
    last = output.strip().splitlines()[-1]
    received, lost = (int(word) for word in last.split() if word.isdigit())
    assert received > 10_000 and lost == 0, last
    assert "Traceback" not in output
