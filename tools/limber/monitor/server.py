"""The web server: viser's, on loopback, for browser pages that it served itself.

viser accepts a WebSocket from any web page that is open in the same browser, and can publish the
server on the internet. Both would let strangers move the arm, so both are closed here.
"""

import gzip
import io
import logging
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout
from pathlib import Path
from typing import Any

import viser
import websockets.asyncio.server
from websockets.http11 import Response

from limber.errors import RunError
from limber.monitor.field_values import keep_possible
from limber.monitor.message_buffer import use_own_buffer
from limber.monitor.page_link import PROTOCOL, PageLink
from limber.paths import ASSETS

HOST = "127.0.0.1"
NAMES = (HOST, "localhost")
LAST_PORT = 65535


class Server(viser.ViserServer):
    """viser's server without its way to the internet, and without its own words on the console.

    `link`: what limber's own part of the page tells. `turn`: held while what a viewer did is taken,
    and by whoever draws what viewers can change, so that neither undoes the other half way.
    """

    def __init__(self, port: int) -> None:
        self.turn = threading.RLock()
        self.link = PageLink(self.turn)
        use_own_buffer()
        with _closed(self.link), redirect_stdout(io.StringIO()):
            super().__init__(host=HOST, port=port, label="limber", verbose=False)
        keep_possible(self.gui)
        self._take_in_turn()

    def _take_in_turn(self) -> None:
        interface: Any = self.gui._websock_interface  # one of its methods is replaced
        take = interface._handle_incoming_message

        async def in_turn(viewer: Any, message: Any) -> None:
            with self.turn:
                await take(viewer, message)

        interface._handle_incoming_message = in_turn

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
def _closed(link: PageLink) -> Iterator[None]:
    """viser calls `serve` while it is constructed, once for each port that it tries."""
    logging.getLogger("websockets.server").setLevel(logging.CRITICAL)  # a refusal is no error
    server: Any = websockets.asyncio.server  # one of its names is replaced
    serve = server.serve

    def checked(handler: Any, host: str, port: int, **options: Any) -> Any:
        options["process_request"] = _own_page(options["process_request"], port)
        select = options["select_subprotocol"]

        def protocol(connection: Any, offered: Any) -> Any:
            return PROTOCOL if PROTOCOL in offered else select(connection, offered)

        async def serve_both(connection: Any) -> None:
            own = connection.subprotocol == PROTOCOL
            await (link.serve(connection) if own else handler(connection))

        options["select_subprotocol"] = protocol
        return serve(serve_both, host, port, origins=allowed_origins(port), **options)

    server.serve = checked
    try:
        yield
    finally:
        server.serve = serve


def _own_page(answer: Callable, port: int) -> Callable:
    """viser's answers with our headers, and its page with our part in it."""
    bodies = {"identity": own_html()}
    bodies["gzip"] = gzip.compress(bodies["identity"])

    def process(connection: Any, request: Any) -> Response | None:
        response: Response | None = answer(connection, request)
        if response is None:
            return None
        response.headers.update(security_headers(port))
        if response.headers.get("Content-Type", "").startswith("text/html"):
            response.body = bodies[response.headers["Content-Encoding"]]
            del response.headers["Content-Length"]
            response.headers["Content-Length"] = str(len(response.body))
        return response

    return process


def own_html() -> bytes:
    """viser's page; before all of its programs ours (assets/page.js)."""
    viser_page = Path(viser.__file__).parent / "client" / "build" / "index.html"
    text = viser_page.read_text(encoding="utf-8").replace(
        "<title>Viser</title>", "<title>limber</title>"
    )
    style, script = (
        (ASSETS / name).read_text(encoding="utf-8") for name in ("page.css", "page.js")
    )
    return text.replace(
        "<head>", f"<head><style>{style}</style><script>{script}</script>", 1
    ).encode()
