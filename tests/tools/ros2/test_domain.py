"""Who may reach the topics: this machine, unless an interface is named."""

import os
import socket
import subprocess
import sys
from contextlib import closing

import pytest

from limber.errors import InputError
from limber.ros2 import domain

DOMAIN = 229  # nobody's
SHOW = """
import os, socket
from limber.ros2.domain import Participant
before = set(os.listdir("/proc/self/fd"))
Participant.kept = Participant(int(os.environ["ROS_DOMAIN_ID"]))
for file in set(os.listdir("/proc/self/fd")) - before:
    try:
        found = socket.socket(fileno=os.dup(int(file)))
    except OSError:
        continue
    if found.family == socket.AF_INET:
        device = found.getsockopt(socket.SOL_SOCKET, socket.SO_BINDTODEVICE, 16)
        print(found.getsockname()[1], device.rstrip(bytes(1)).decode())
"""


@pytest.mark.parametrize("word", ["233", "-1", "one", "1.5", "²"])
def test_no_domain(word, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", word)
    with pytest.raises(InputError, match="expected a number from 0 to 232"):
        domain.domain_id()


def test_the_domain_is_ros_domain_id(monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", "42")
    assert domain.domain_id() == 42
    monkeypatch.setenv("ROS_DOMAIN_ID", "")
    assert domain.domain_id() == 0


def test_an_interface_that_is_not_there():
    with pytest.raises(InputError, match="no network interface 'eth77'; there are lo"):
        domain.Participant(DOMAIN, "eth77")


def test_every_socket_is_bound_to_the_loopback():
    """Whatever $CYCLONEDDS_URI allows: the kernel drops what comes by another device."""
    general = "<General><AllowMulticast>true</AllowMulticast></General>"
    anywhere = f"<CycloneDDS><Domain>{general}</Domain></CycloneDDS>"
    env = {**os.environ, "CYCLONEDDS_URI": anywhere, "ROS_DOMAIN_ID": str(DOMAIN)}
    done = subprocess.run(
        [sys.executable, "-c", SHOW], env=env, capture_output=True, text=True, check=True
    )
    sockets = [line.partition(" ")[::2] for line in done.stdout.splitlines()]
    assert {device for _, device in sockets} == {"lo"}
    ports = {int(port) for port, _ in sockets}
    assert any((port - 7410 - 250 * DOMAIN) in range(250) for port in ports), "it listens"


def test_other_sockets_stay_as_they_are():
    with closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as mine:
        kept = domain.Participant(DOMAIN)
        assert kept and mine.getsockopt(socket.SOL_SOCKET, socket.SO_BINDTODEVICE, 16) == b""
