"""Where a log may be sent: LCM addresses on this machine, never the arm plane."""

import os
from dataclasses import dataclass
from urllib.parse import parse_qs, urlsplit

from limber import messages
from limber.errors import InputError


@dataclass(frozen=True)
class Address:
    """`private`: no process of limber listens on its port. Another group is not enough: a socket
    hears every group of its port that anybody on the machine has joined.
    """

    url: str
    port: int
    private: bool


def address(url: str | None) -> Address:
    """`url`, or the user plane; InputError if messages would leave this machine or reach an arm."""
    chosen = url or messages.user_plane_url()
    port = _port(chosen)
    planes = {"arm": messages.plane_url("arm"), "user": messages.plane_url("user")}
    ports = {name: _port(plane) for name, plane in planes.items()}
    if port == ports["arm"]:
        raise InputError(
            f"--url {chosen}: port {port} is the arm plane's, where drivers listen; "
            f"take another one, such as udpm://239.255.76.67:7700?ttl=0"
        )
    default = _port(messages.user_plane_url())
    return Address(chosen, port, private=port not in (*ports.values(), default))


def _port(url: str) -> int:
    parts = urlsplit(url)
    options = parse_qs(parts.query)
    try:
        port = parts.port
    except ValueError:
        port = None
    if parts.scheme != "udpm" or not parts.hostname or port is None:
        raise InputError(f"--url {url}: expected udpm://GROUP:PORT?ttl=0")
    if options.get("ttl") != ["0"] and os.environ.get("LIMBER_ALLOW_REMOTE") != "1":
        raise InputError(
            f"--url {url}: messages would leave this machine; end it in ?ttl=0, or set "
            "LIMBER_ALLOW_REMOTE=1 if that is what you want"
        )
    return port
