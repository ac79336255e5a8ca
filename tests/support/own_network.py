"""For tests of other people's software, which may speak to whoever is in reach."""

import ctypes
import os

import pytest

from limber.live import private_network

CLONE_NEWUSER, CLONE_NEWNET = 0x10000000, 0x40000000


def leave_the_machines_network() -> None:
    """This process and its children: from here on in a network of their own."""
    kind = CLONE_NEWNET if os.geteuid() == 0 else CLONE_NEWNET | CLONE_NEWUSER
    if ctypes.CDLL(None, use_errno=True).unshare(kind) != 0:
        pytest.skip("no network namespace of its own is permitted here")
    private_network.set_up()
