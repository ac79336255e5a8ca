"""Whatever arrives at their sockets, driver, controller, simulator and recorder live on.

Garbled messages on the channels that they listen to, and datagrams that are none of LCM's.
"""

import random
import socket
import struct
import subprocess

from limber import messages
from stack import BIN, ROOT

CORPUS = ROOT / "tests" / "fuzz" / "corpus" / "messages"
TYPES = sorted(path.stem for path in (ROOT / "lcmtypes").glob("*.lcm"))
PLANES = (("239.255.76.67", 7667), ("239.255.76.68", 7668))
DATAGRAMS = 6000
AT_ONCE = 20  # then the reader gets time to read


def channels_of(type_name: str) -> list[str]:
    table = messages.channels()
    return [name for name, channel in table.items() if channel.type_name == type_name]


def kept() -> list[tuple[str, bytes]]:
    """(channel, message), of every type that a channel carries."""
    found = []
    for path in sorted(CORPUS.iterdir()):
        data = path.read_bytes()
        for channel in channels_of(TYPES[data[0] % len(TYPES)]):
            found.append((channel, data[1:]))
    return found


def garble(data: bytearray, choose: random.Random) -> None:
    """`data`: a message, or the whole datagram."""
    for _ in range(choose.randint(1, 4)):
        at = choose.randrange(len(data))
        kind = choose.randrange(5)
        if kind < 2:
            data[at] = choose.randrange(256)
        elif kind == 2:
            data[at : at + 4] = struct.pack(">i", choose.choice([-1, 0, 1, -(2**31), 2**31 - 1]))
        elif kind == 3:
            data[at : at + 8] = struct.pack(">d", choose.choice([float("nan"), 1e308, -1e308]))
        elif len(data) > 8:
            del data[at : at + choose.randrange(1, 8)]


def datagram(number: int, channel: str, message: bytes, choose: random.Random) -> bytes:
    body = bytearray(message)
    garble(body, choose)
    whole = bytearray(b"LC02" + struct.pack(">I", number) + channel.encode() + b"\0" + body)
    if choose.random() < 0.2:
        garble(whole, choose)
    if choose.random() < 0.1:
        whole[3:4] = b"3"  # a fragment of a longer message
    return bytes(whole)


def test_garbled_datagrams_end_no_process(stack, tmp_path):
    recorder = subprocess.Popen([BIN / "limber-record", "--out", tmp_path / "run.lcmlog"])
    stack.start_all()
    stack.until(lambda: stack.user.count("JOINT_TORQUE") > 0, 20, "the controller answers")
    choose, inputs = random.Random(1), kept()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        for number in range(DATAGRAMS):
            data = datagram(number, *choose.choice(inputs), choose)
            sender.sendto(data, choose.choice(PLANES))
            if number % AT_ONCE == 0:
                stack.until(lambda: True, 1, "all are alive")
    before = stack.user.count("JOINT_STATE"), stack.user.count("SIM_TRUTH")
    more = lambda: stack.user.count("JOINT_STATE") > before[0] + 100  # noqa: E731
    stack.until(more, 20, "the driver goes on")
    stack.until(lambda: stack.user.count("SIM_TRUTH") > before[1] + 100, 20, "so does the arm")
    for name in ("sim", "controller", "driver"):
        assert stack.processes[name].poll() is None, stack.log(name)
    assert recorder.poll() is None
    recorder.terminate()
    assert recorder.wait(timeout=300) == 0
