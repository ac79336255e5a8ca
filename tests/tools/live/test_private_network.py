"""A network of its own, made without `ip`."""

import subprocess
import sys

import pytest

from limber.live import network

INSIDE = (
    "import socket; from limber.live.network import multicast_works; "
    "print(multicast_works(), [name for _, name in socket.if_nameindex()])"
)


def test_multicast_works_in_it_and_nothing_else_is_there(monkeypatch):
    prefix = network.private_command()
    if prefix is None:
        pytest.skip("this machine permits no network namespace")
    assert "ip" not in prefix
    done = subprocess.run(
        [*prefix, sys.executable, "-c", INSIDE], capture_output=True, text=True, check=False
    )
    assert done.stdout == "True ['lo']\n", done.stderr
