"""What a neighbour on the user plane may send: whoever listens in Python lives on."""

import os
import pty
import signal
import socket
import struct
import subprocess
import sys
from contextlib import closing, suppress

import pytest
from processes import started

from limber.live.line import Line
from stack import USER_URL

PLANE = ("239.255.76.67", 7667)
CHANNEL = "JOINT_STATE"
LONG_NAME = "N" * 63
CALM_S = 20.0


def short(name: bytes, data: bytes = b"", head: bytes = b"LC02") -> bytes:
    return head + struct.pack(">I", 7) + name + data


def fragment(size: int, offset: int, number: int, count: int, data: bytes) -> bytes:
    return struct.pack(">4sIIIHH", b"LC03", 9, size, offset, number, count) + data


MALFORMED = {
    "a name without a zero": short(b"JOINT_STATE"),
    "a head alone": short(b""),
    "half a head": b"LC02\0\0",
    "nothing": b"",
    "another protocol": short(b"JOINT_STATE\0", b"data", head=b"LC09"),
    "a name of 64 bytes": short(b"N" * 64 + b"\0", b"data"),
    "a name of 300 bytes": short(b"N" * 300 + b"\0", b"data"),
    "a name without a zero, 60 kB": short(b"N" * 60_000),
    "a fragment alone": b"LC03\0\0\0\x09",
    "a fragment beyond its message": fragment(10, 8, 1, 3, b"abcd"),
    "an offset beyond all": fragment(10, 0xFFFFFFFF, 1, 3, b"abcd"),
    "a size beyond all": fragment(0xFFFFFFFF, 0, 1, 3, b"abcd"),
    "a number beyond the count": fragment(10, 0, 3, 3, b"abcd"),
    "a first fragment whose name does not end": fragment(10, 0, 0, 3, b"JOINT_STATE"),
}


@pytest.fixture
def neighbour():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        yield lambda data: sender.sendto(data, PLANE)


@pytest.fixture
def heard():
    """(line, what arrives on CHANNEL and LONG_NAME)"""
    with closing(Line(USER_URL)) as line:
        arrived: list[bytes] = []
        for name in (CHANNEL, LONG_NAME):
            line.subscribe(name, lambda _name, data: arrived.append(data))
        yield line, arrived


def until(line: Line, arrived: list[bytes], wanted: bytes) -> None:
    while not arrived or arrived[-1] != wanted:
        assert line.handle_timeout(1000 * CALM_S), "nothing arrives any more"


@pytest.mark.parametrize("what", MALFORMED)
def test_what_is_no_message_is_counted_and_the_next_one_heard(neighbour, heard, what):
    line, arrived = heard
    neighbour(MALFORMED[what])
    neighbour(short(b"JOINT_STATE\0", b"the next"))
    until(line, arrived, b"the next")
    assert arrived == [b"the next"]
    assert line.malformed() == 1


def test_the_longest_name_and_an_empty_message_are_heard(neighbour, heard):
    line, arrived = heard
    neighbour(short(LONG_NAME.encode() + b"\0"))
    neighbour(short(b"\0", b"of a channel without a name"))
    neighbour(short(b"JOINT_STATE\0", b"the next"))
    until(line, arrived, b"the next")
    assert arrived == [b"", b"the next"]
    assert line.malformed() == 0


def test_fragments_come_together_whatever_is_repeated(neighbour, heard):
    line, arrived = heard
    first = fragment(10, 0, 0, 3, b"JOINT_STATE\0abcd")
    second, third = fragment(10, 4, 1, 3, b"efgh"), fragment(10, 8, 2, 3, b"ij")
    for data in (third, first, first, third, first, second, second):
        neighbour(data)
    until(line, arrived, b"abcdefghij")
    long = bytes(range(256)) * 3900  # nearly 1 MB, in 16 datagrams
    parts = [long[i : i + 63_000] for i in range(0, len(long), 63_000)]
    for number, part in enumerate(parts):
        name = b"JOINT_STATE\0" if number == 0 else b""
        neighbour(fragment(len(long), 63_000 * number, number, len(parts), name + part))
    until(line, arrived, long)
    assert arrived == [b"abcdefghij", long]
    assert line.malformed() == 0


def test_a_flood_of_all_of_it_hides_no_message(neighbour, heard):
    line, arrived = heard
    for number in range(2000):
        for data in MALFORMED.values() if number % 20 == 0 else ():
            neighbour(data)
        neighbour(short(b"JOINT_STATE\0", number.to_bytes(4, "big")))
        line.handle_timeout(0)
    until(line, arrived, (1999).to_bytes(4, "big"))
    assert [int.from_bytes(data, "big") for data in arrived] == list(range(2000))
    assert line.malformed() == 100 * len(MALFORMED)


SCRIPT = """
import sys
from limber import Arm
with Arm() as arm:
    print("hears", flush=True)
    sys.stdin.readline()
    arm.wait(for_s=0.2)
    print("still hears", flush=True)
"""


def bombard(neighbour) -> None:
    for data in MALFORMED.values():
        neighbour(data)


def test_a_script_survives(stack, neighbour):
    stack.start_all()
    stack.until(lambda: stack.mode is not None, 20, "the controller answers")
    with started(
        [sys.executable, "-c", SCRIPT], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as script:
        assert script.stdout.readline() == "hears\n"
        bombard(neighbour)
        out, _ = script.communicate("\n", timeout=300)
    assert (script.returncode, out) == (0, "still hears\n")


def read_terminal(terminal: int, size: int) -> None:
    """OSError if the program at the other end has ended before it wrote so much."""
    while size > 0:
        size -= len(os.read(terminal, 65536))


def drain(terminal: int) -> None:
    with suppress(OSError):
        while os.read(terminal, 65536):
            pass


def test_watch_survives(stack, neighbour):
    stack.start_all()
    stack.until(lambda: stack.mode is not None, 20, "the controller answers")
    ours, theirs = pty.openpty()
    command = [sys.executable, "-m", "limber", "watch"]
    with started(command, stdin=theirs, stdout=theirs, stderr=theirs) as watch:
        os.close(theirs)
        read_terminal(ours, 2000)
        bombard(neighbour)
        read_terminal(ours, 20_000)
        watch.send_signal(signal.SIGINT)
        drain(ours)
        watch.wait(timeout=300)
    os.close(ours)
    assert watch.returncode >= 0, "ended by a signal"


def test_the_simulator_counts_what_it_cannot_read(stack, neighbour):
    stack.start_all()
    stack.until(lambda: stack.mode is not None, 20, "the controller answers")
    for channel in (b"PUSH", b"SCENARIO_EVENT", b"WORKPIECE"):
        neighbour(short(channel + b"\0", b"no message"))
        neighbour(short(channel + b"\0"))
    told = "messages to the simulator (PUSH, SCENARIO_EVENT, WORKPIECE) were dropped"
    stack.until(lambda: f"6 {told}" in stack.log("sim"), 20, "all six are told")
