"""The web server: viser's, on loopback, for browser pages that it served itself.

viser accepts a WebSocket from any web page that is open in the same browser, and can publish the
server on the internet. Both would let strangers move the arm, so both are closed here.
"""

import io
import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout
from typing import Any

import viser
import websockets.asyncio.server
from websockets.http11 import Response

from limber.errors import RunError

HOST = "127.0.0.1"
NAMES = (HOST, "localhost")
LAST_PORT = 65535


class Server(viser.ViserServer):
    """viser's server without its way to the internet, and without its own words on the console."""

    def __init__(self, port: int) -> None:
        with _closed(), redirect_stdout(io.StringIO()):
            super().__init__(host=HOST, port=port, label="limber", verbose=False)

    def close(self) -> None:
        with redirect_stdout(io.StringIO()):
            self.stop()

    @property
    def url(self) -> str:
        return f"http://{HOST}:{self.get_port()}"

    def request_share_url(self, verbose: bool = True) -> None:
        """Any page may send the request; a robot is never published."""


def start(port: int) -> Server:
    """Serves at `port`, or at the next one that is free."""
    if not 1 <= port <= LAST_PORT:
        raise RunError(f"port {port} does not exist: give one from 1 to {LAST_PORT}")
    return Server(port)


def allowed_origins(port: int) -> list[str | None]:
    """None: programs other than browsers, which send no Origin."""
    return [None, *(f"http://{name}:{port}" for name in NAMES)]


def security_headers(port: int) -> dict[str, str]:
    """The browser loads nothing from elsewhere and shows the page in no other page's frame."""
    sockets = " ".join(f"ws://{name}:{port}" for name in NAMES)
    local = "'self' data: blob:"
    policy = (
        f"default-src {local} 'unsafe-inline' 'unsafe-eval'; connect-src {local} {sockets}; "
        "frame-ancestors 'none'"
    )
    return {"Content-Security-Policy": policy, "X-Frame-Options": "DENY"}


@contextmanager
def _closed() -> Iterator[None]:
    """viser calls `serve` while it is constructed, once for each port that it tries."""
    logging.getLogger("websockets.server").setLevel(logging.CRITICAL)  # a refusal is no error
    serve = websockets.asyncio.server.serve

    def checked(handler: Any, host: str, port: int, **options: Any) -> Any:
        options["process_request"] = _with_headers(options["process_request"], port)
        return serve(handler, host, port, origins=allowed_origins(port), **options)

    websockets.asyncio.server.serve = checked
    try:
        yield
    finally:
        websockets.asyncio.server.serve = serve


def _with_headers(answer: Callable, port: int) -> Callable:
    def process(connection: Any, request: Any) -> Response | None:
        response = answer(connection, request)
        if response is not None:
            response.headers.update(security_headers(port))
        return response

    return process
