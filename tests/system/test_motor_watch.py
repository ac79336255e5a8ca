"""`limber motors watch`: what motors measure that are off, as text that never commands."""

from __future__ import annotations

import os
import pty
import signal
import subprocess
import sys
import time
from contextlib import contextmanager

import can
import pytest
import yaml
from local_drive import multicast_group
from motor_bus import forgetful_drive, frames_of, sending

from stack import ROOT

TORQUE = can.Message(arbitration_id=1, data=b"\x7f\xff\x7f\xf0\0\0\x07\xff", is_extended_id=False)
SOON_S = 60.0


@contextmanager
def watching(robot: str, *words: str, output: int = subprocess.PIPE):
    fd = ["--fd"] if robot in ("planar2r", "testbench") else []
    command = [sys.executable, "-m", "limber", "motors", "watch", f"virtual:{robot}", *words, *fd]
    child = subprocess.Popen(command, stdout=output, stderr=subprocess.PIPE, text=True)
    try:
        yield child
    finally:
        child.kill()
        child.wait()


def block(child: subprocess.Popen) -> list[list[str]]:
    """The next table without its head, in words."""
    while not child.stdout.readline().startswith("motor "):
        assert child.poll() is None, child.stderr.read()
    child.stdout.readline()
    rows = []
    while line := child.stdout.readline().split():
        rows.append(line)
    return rows


@pytest.mark.parametrize("robot", ["axol", "desktop2r", "edulite_a3", "planar2r", "testbench"])
def test_angles_are_those_of_the_arm(motors, stack, robot):
    motors(robot)
    described = yaml.safe_load((ROOT / "robots" / robot / "robot.yaml").read_text(encoding="utf-8"))
    with watching(robot) as child:
        rows = {row[0]: row for row in block(child)}
    joints = list(described["joints"].values())
    assert len(rows) == len(joints)
    for joint, angle in zip(joints, stack.positions, strict=True):
        family = described["motors"][joint["motor"]]["protocol"]
        row = rows[f"{family}:{int(str(joint['id']), 0)}"]
        found = joint.get("sign", 1) * (float(row[1]) - joint.get("offset_rad", 0.0))
        assert abs(found - angle) < 5e-3, row
        assert row[4] == ("-" if family == "cia402" else "30")  # degC
        assert row[5] == ("-" if family == "damiao_mit" else "48.0")  # V
        assert (row[3] == "-") == (family in ("robstride", "myactuator"))


def test_it_goes_on_until_ctrl_c_and_only_reads(motors):
    motors("desktop2r")
    with frames_of("desktop2r") as heard, watching("desktop2r", "damiao_mit:2") as child:
        for _ in range(2):
            assert [row[0] for row in block(child)] == ["damiao_mit:2"]
        child.send_signal(signal.SIGINT)
        assert child.wait(SOON_S) == 0
    requests = [
        frame for frame in heard if frame.arbitration_id < 0x10 or frame.arbitration_id == 0x7FF
    ]
    assert requests and all(frame.arbitration_id == 0x7FF for frame in requests)
    assert {frame.data[2] for frame in requests} == {0x33, 0xCC}  # reads and requests of the state


def test_a_motor_that_falls_silent_has_its_line(motors, stack):
    motors("desktop2r")
    with watching("desktop2r") as child:
        assert block(child)[0][-1] == "disabled"
        stack.kill("sim")
        end = time.monotonic() + SOON_S
        while (rows := block(child))[0][-1] == "disabled":
            assert time.monotonic() < end
        assert [row[6:8] for row in block(child)] == [["NO", "ANSWER:"]] * 2, rows


def test_an_error_is_in_words():
    with forgetful_drive("watched", error=0xB), watching("watched", "damiao_mit:1") as child:
        assert " ".join(block(child)[0][6:]) == "power stage too hot"


def test_it_leaves_a_bus_to_others(motors):
    call = motors("desktop2r")
    with watching("desktop2r") as child:
        block(child)
        with sending("desktop2r", TORQUE):
            assert child.wait(SOON_S) == 3
            assert "somebody sends on this bus" in child.stderr.read()
            refused = call("watch")
    assert refused.returncode == 3 and refused.stdout == ""
    with can.Bus(
        interface="udp_multicast", channel=multicast_group("desktop2r"), hop_limit=0
    ) as bus:
        enable = bytes([0xFF] * 7 + [0xFC])
        bus.send(can.Message(arbitration_id=2, data=enable, is_extended_id=False))
    refused = call("watch")
    assert refused.returncode == 3 and "damiao_mit:2: its power stage is on" in refused.stderr


def test_on_a_terminal_the_table_stays_in_its_place(motors):
    motors("desktop2r")
    master, slave = pty.openpty()
    with watching("desktop2r", output=slave):
        text = b""
        while text.count(b"damiao_mit:1") < 2:
            text += os.read(master, 4096)
    os.close(slave)
    os.close(master)
    assert text.count(b"\x1b[4A") >= 1 and text.count(b"\n\r\n") == 0


def test_nobody_to_watch(limber):
    done = limber("motors", "watch", "virtual:nobody")
    assert done.returncode == 3 and "no motor answers" in done.stderr
