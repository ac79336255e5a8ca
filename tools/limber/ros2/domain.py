"""This process in a DDS domain: on the loopback alone, or on an interface that is named."""

import os
import socket
from contextlib import closing
from typing import Any
from xml.sax.saxutils import quoteattr

from cyclonedds.core import DDSException
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from limber.errors import InputError, RunError

LOOPBACK = "lo"
FILES = "/proc/self/fd"
HIGHEST_DOMAIN = 232  # its ports are the last below 65536
DEPTH = 10  # rmw_qos_profile_default
# Without multicast, which few loopbacks have: a participant is announced to the ports that others
# on this machine may have, each second.
ALONE = (
    "<General><Interfaces><NetworkInterface name='lo'/></Interfaces>"
    "<AllowMulticast>false</AllowMulticast></General><Discovery>"
    "<ParticipantIndex>auto</ParticipantIndex><SPDPInterval>1s</SPDPInterval>"
    "<Peers><Peer address='127.0.0.1'/></Peers></Discovery>"
)


def domain_id() -> int:
    """$ROS_DOMAIN_ID, or 0."""
    word = os.environ.get("ROS_DOMAIN_ID") or "0"
    if not (word.isascii() and word.isdigit() and int(word) <= HIGHEST_DOMAIN):
        raise InputError(f"ROS_DOMAIN_ID={word}: expected a number from 0 to {HIGHEST_DOMAIN}")
    return int(word)


class Participant:
    """`interface`: a network interface by name. To be made before other sockets are opened in
    parallel. RunError if DDS cannot start.
    """

    def __init__(self, domain: int, interface: str = LOOPBACK) -> None:
        names = [name for _, name in socket.if_nameindex()]
        if interface not in names:
            raise InputError(f"no network interface {interface!r}; there are {', '.join(names)}")
        own = f"<NetworkInterface name={quoteattr(interface)}/>"
        chosen = f"<General><Interfaces>{own}</Interfaces></General>"
        chosen = ALONE if interface == LOOPBACK else chosen
        before = set(os.listdir(FILES))
        try:
            self._domain = Domain(domain, f"<CycloneDDS><Domain>{chosen}</Domain></CycloneDDS>")
            if interface == LOOPBACK:
                _shut_in(set(os.listdir(FILES)) - before)
            self.entity = DomainParticipant(domain)
        except DDSException as error:
            raise RunError(f"DDS does not start in domain {domain}: {error}") from error

    def writer(self, topic: str, kind: Any, latched: bool = False) -> DataWriter:
        """As rclpy's default: reliable, the newest ten. `latched`: one, for late readers, too."""
        return DataWriter(self.entity, self._topic(topic, kind), qos=_qos(latched, DEPTH))

    def reader(self, topic: str, kind: Any) -> DataReader:
        """Keeps the newest only."""
        return DataReader(self.entity, self._topic(topic, kind), qos=_qos(False, 1))

    def _topic(self, name: str, kind: Any) -> Topic:
        return Topic(self.entity, f"rt{name}", kind)  # rt: ROS's topics


def _qos(latched: bool, depth: int) -> Any:
    return Qos(
        Policy.Reliability.Reliable(duration(milliseconds=10)),
        Policy.Durability.TransientLocal if latched else Policy.Durability.Volatile,
        Policy.History.KeepLast(1 if latched else depth),
        Policy.DataRepresentation(use_cdrv0_representation=True),
    )


def _shut_in(files: set[str]) -> None:
    """Cyclone DDS receives at every address of the machine; now the kernel drops other devices'."""
    for file in files:
        try:
            found = socket.socket(fileno=os.dup(int(file)))
        except OSError:
            continue  # no socket
        with closing(found):
            if found.family == socket.AF_INET and found.type == socket.SOCK_DGRAM:
                found.setsockopt(
                    socket.SOL_SOCKET, socket.SO_BINDTODEVICE, f"{LOOPBACK}\0".encode()
                )
