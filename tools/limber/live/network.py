"""Multicast on this machine: does it work, and a private network for a run where it does not."""

import os
import shutil
import socket
import subprocess
import sys
from typing import NoReturn

from limber.errors import InputError, RunError
from limber.live import private_network

GROUP = "239.255.76.67"  # LCM's; with another port, which disturbs no messages
CURE = "sudo ip link set lo multicast on && sudo ip route add 224.0.0.0/4 dev lo"
_INSIDE = "LIMBER_PRIVATE_NETWORK"


def multicast_works(wait_s: float = 0.5) -> bool:
    """Sends one datagram to a multicast group that stays on this machine, and listens for it."""
    try:
        with (
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver,
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender,
        ):
            receiver.bind(("", 0))
            membership = socket.inet_aton(GROUP) + socket.inet_aton("0.0.0.0")
            receiver.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)
            receiver.settimeout(wait_s)
            sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
            sender.sendto(b"limber", (GROUP, receiver.getsockname()[1]))
            return receiver.recv(64) == b"limber"
    except OSError:
        return False


def is_private() -> bool:
    return os.environ.get(_INSIDE) == "1"


def private_command() -> list[str] | None:
    """Prefix that runs a command in a network of its own; None if that is not permitted here."""
    if shutil.which("unshare") is None:
        return None
    flags = "-n" if os.geteuid() == 0 else "-rn"
    prefix = ["unshare", flags, sys.executable, "-I", private_network.__file__]
    probe = subprocess.run([*prefix, "true"], capture_output=True, check=False)
    return prefix if probe.returncode == 0 else None


def enter_private() -> NoReturn:
    """Starts this very command again inside a private network."""
    prefix = private_command()
    if prefix is None:
        raise RunError(f"this machine permits no private network; add a multicast route: {CURE}")
    sys.stdout.flush()
    os.environ[_INSIDE] = "1"
    command = [*prefix, sys.executable, "-m", "limber", *sys.argv[1:]]
    os.execvp(command[0], command)


def require_multicast() -> None:
    """For commands that need a running stack: a private network is no substitute."""
    if not multicast_works():
        raise RunError(f"no multicast route on this machine, so no message arrives: {CURE}")


def require_shared_network(private: bool, lacks: str = "this machine's CAN interfaces") -> None:
    """For runs that need what a private network lacks."""
    if is_private():
        return
    if private:
        raise InputError(f"--private: a private network has none of {lacks}")
    if not multicast_works():
        raise RunError(f"no multicast route on this machine, which LCM needs: {CURE}")


def ensure_multicast(private: bool) -> None:
    """Returns if LCM works here; else starts this command again in a private network."""
    if is_private() or (not private and multicast_works()):
        return
    if not private:
        print(
            "No multicast route on this machine: continuing in a private network, invisible to "
            f"other terminals.\nTo watch from another terminal: {CURE}",
            file=sys.stderr,
        )
    enter_private()
