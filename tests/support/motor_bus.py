"""A bus with motors that nobody commands: what is sent on it, and a drive with a defect."""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import contextmanager

import can
from local_drive import multicast_group


def open_bus(name: str) -> can.BusABC:
    return can.Bus(interface="udp_multicast", channel=multicast_group(name), hop_limit=0)


@contextmanager
def meanwhile(name: str, act: Callable[[can.BusABC, threading.Event], None]):
    """`act` on the bus of this name in a thread of its own, until the event is set."""
    end = threading.Event()
    with open_bus(name) as bus:
        thread = threading.Thread(target=act, args=(bus, end))
        thread.start()
        try:
            yield
        finally:
            end.set()
            thread.join()


def sending(robot: str, frame: can.Message, every_s: float = 0.02):
    """Another program on the bus."""

    def send(bus: can.BusABC, end: threading.Event) -> None:
        while not end.wait(every_s):
            bus.send(frame)

    return meanwhile(robot, send)


@contextmanager
def frames_of(robot: str):
    """What is sent on its bus meanwhile."""
    heard: list[can.Message] = []
    with open_bus(robot) as bus:
        yield heard
        while message := bus.recv(0.3):
            heard.append(message)


@contextmanager
def all_frames_of(robot: str):
    """The same where drives never cease to send by themselves."""
    heard: list[can.Message] = []

    def listen(bus: can.BusABC, end: threading.Event) -> None:
        while not end.is_set():
            if message := bus.recv(0.1):
                heard.append(message)

    with meanwhile(robot, listen):
        yield heard


def forgetful_drive(bus_name: str, error: int = 0):
    """A Damiao drive, number 1, that takes a value and has the old one as soon as it stores it.
    `error`: the first four bits of its state.
    """
    registers = {}

    def serve(bus: can.BusABC, end: threading.Event) -> None:
        while not end.is_set():
            request = bus.recv(0.1)
            if request is None or request.arbitration_id != 0x7FF or request.data[0] != 1:
                continue
            operation, register = request.data[2], request.data[3]
            if operation == 0x55:
                registers[register] = bytes(request.data[4:])
            if operation == 0xAA:
                registers.clear()
            answer = bytes(request.data[:4]) + registers.get(register, bytes(4))
            if operation == 0xCC:  # its state
                answer = bytes((error << 4 | 1, 0x7F, 0xFF, 0x7F, 0xF7, 0xFF, 30, 30))
            bus.send(can.Message(arbitration_id=0x11, data=answer, is_extended_id=False))

    return meanwhile(bus_name, serve)
