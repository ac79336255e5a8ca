"""System tests run in a private network namespace: `limber test` starts pytest inside one."""

import socket

import pytest

from stack import Stack


def pytest_configure(config):
    """Refuse to run where other LCM programs could hear us or disturb us."""
    interfaces = [name for _, name in socket.if_nameindex()]
    others = [
        name
        for name in interfaces
        if name != "lo" and not name.startswith(("vcan", "vxcan", "can"))
    ]
    if others:
        pytest.exit(
            "system tests need a private network: run them with `./limber test`, or\n"
            "  unshare -rn sh -c 'ip link set lo up; ip link set lo multicast on; "
            "ip route add 224.0.0.0/4 dev lo; .venv/bin/pytest tests/system'",
            returncode=4,
        )


@pytest.fixture
def stack(tmp_path):
    running = Stack(tmp_path)
    yield running
    running.close()
