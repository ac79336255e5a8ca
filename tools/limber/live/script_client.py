"""The number of this process as a client, and the lock that tells that it lives."""

import functools
import os
import socket

from limber.errors import InputError
from limber.messages import NUM_SCRIPT_CLIENTS, SCRIPT_CLIENT


def script_client() -> int:
    """One number a process, from a few that scripts share: a controller knows 64 clients in a run.

    The process holds it, an abstract Unix socket of this network namespace, until it ends: then the
    controller gives its lease to the next who asks (controller/client_life.h).
    """
    return _held_by(os.getpid())[0]


@functools.cache
def _held_by(pid: int) -> tuple[int, socket.socket]:
    lock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    for i in range(NUM_SCRIPT_CLIENTS):
        client = SCRIPT_CLIENT + (pid + i) % NUM_SCRIPT_CLIENTS
        try:
            lock.bind(f"\0limber client {client}")
        except OSError:
            continue  # another process has it
        lock.listen(1)
        return client, lock
    lock.close()
    raise InputError(f"more than {NUM_SCRIPT_CLIENTS} scripts control the arm: end some of them")
