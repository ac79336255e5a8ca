"""`limber motors` against the emulated drives of each family, and beside others on the bus."""

from __future__ import annotations

import struct

import can
import pytest
from local_drive import multicast_group
from motor_bus import all_frames_of, forgetful_drive, frames_of, sending

ARMS = {
    "axol": ("myactuator", (1, 2, 3, 4, 5)),
    "desktop2r": ("damiao_mit", (1, 2)),
    "desktop2r_ak": ("cubemars", (1, 2)),
    "desktop2r_odrive": ("odrive", (1, 2)),
    "edulite_a3": ("robstride", (1, 2, 3, 4, 5, 6)),
    "planar2r": ("moteus", (1, 2)),
    "testbench": ("cia402", (1,)),
}

OTHERS = {"axol": ["damiao_mit:6", "damiao_mit:7"]}  # on the same bus


def listed(done) -> list[str]:
    return [line.split()[0] for line in done.stdout.splitlines()]


@pytest.mark.parametrize("robot", sorted(ARMS))
def test_scan_finds_the_motors_and_no_others(motors, robot):
    family, numbers = ARMS[robot]
    call = motors(robot)
    done = call("scan")
    assert done.returncode == 0, done.stderr
    expected = [f"{family}:{number}" for number in numbers]
    assert listed(done) == OTHERS.get(robot, []) + expected
    shown = call("show", f"{family}:1")
    assert shown.returncode == 0, shown.stderr
    *settings, head, _, measured = shown.stdout.splitlines()
    assert len(settings) >= 4 and "angle" in head and measured.startswith(f"{family}:1 ")


@pytest.mark.parametrize(("robot", "number"), [("desktop2r", 5), ("edulite_a3", 100), ("axol", 30)])
def test_number_and_zero(motors, robot, number):
    family = ARMS[robot][0]
    call = motors(robot)
    taken = call("set-id", f"{family}:1", "2")
    assert taken.returncode == 3 and "a motor answers to 2 already" in taken.stderr
    done = call("set-id", f"{family}:1", str(number))
    assert done.returncode == 0, done.stderr
    assert f"{family}:{number}" in listed(call("scan"))
    gone = call("show", f"{family}:1")
    assert gone.returncode == 3 and "does not answer" in gone.stderr
    assert call("zero", f"{family}:{number}").returncode == 0
    shown = call("show", f"{family}:{number}").stdout
    assert abs(float(shown.splitlines()[-1].split()[1])) < 0.01


def test_an_odrive_gets_a_number_and_keeps_no_zero(motors):
    call = motors("desktop2r_odrive")
    with all_frames_of("desktop2r_odrive") as heard:
        done = call("set-id", "odrive:1", "40")
    assert done.returncode == 0, done.stderr
    sent = [f"{one.arbitration_id:03X}#{bytes(one.data).hex().upper()}" for one in heard]
    assert "7E6#2801000000003000" in sent and "516#01" in sent  # its serial number, then: save
    assert listed(call("scan")) == ["odrive:2", "odrive:40"]
    shown = call("show", "odrive:40").stdout
    assert "0.6.11" in shown and "01 00 00 00 00 30" in shown and "idle" in shown
    kept = call("zero", "odrive:40")
    assert kept.returncode == 3 and "offset_rad" in kept.stderr
    refused = call("set-id", "odrive:40", "63")
    assert refused.returncode == 3 and "no number" in refused.stderr


def test_a_scan_leaves_an_odrive_alone(motors):
    """What asks other families would command it: 7FF starts the update of its firmware."""
    with all_frames_of("desktop2r_odrive") as heard:
        motors("desktop2r_odrive")("scan")
    told = {one.arbitration_id for one in heard if not one.is_remote_frame and len(one.data) > 0}
    of_nodes = {number for number in told if number >> 5 in (1, 2, 63)}
    assert {number & 0x1F for number in of_nodes} <= {0x00, 0x01, 0x06, 0x09}  # told by the nodes
    assert any(number >> 5 not in (1, 2, 63) for number in told)


@pytest.mark.parametrize(
    ("robot", "motor", "frame"),
    [
        ("desktop2r", "damiao_mit:1", "7FF#0100552303000000"),
        ("axol", "myactuator:1", "141#B400000000000000"),
        ("edulite_a3", "robstride:1", "1700FD01#0102030405060200"),
    ],
)
def test_bit_rate(motors, robot, motor, frame):
    """Emulated drives have theirs at once, but RobStride's wait for the power."""
    call = motors(robot)
    others = [word for word in listed(call("scan")) if word != motor]
    same = call("set-baud", motor, "1000000")
    assert same.returncode == 0 and "silent at any other rate" in same.stdout
    assert ("stored and read back" in same.stdout) == (motor == "damiao_mit:1")
    wrong = call("set-baud", motor, "333333")
    assert wrong.returncode == 2 and "500000" in wrong.stderr
    with frames_of(robot) as heard:
        done = call("set-baud", motor, "500000")
    assert done.returncode == 0, done.stderr
    sent = [f"{one.arbitration_id:03X}#{bytes(one.data).hex().upper()}" for one in heard]
    assert frame in [
        word.removeprefix("0") if one.is_extended_id else word
        for one, word in zip(heard, sent, strict=True)
    ]
    waits = motor.startswith("robstride")
    assert ("when its supply was off" in done.stdout) == waits
    assert listed(call("scan")) == ([motor, *others] if waits else others)


def test_a_bit_rate_that_does_not_stick(limber):
    """Of a drive that answers to the new code and has the old one (openarm, issue 471)."""
    with forgetful_drive("forgetful"):
        done = limber("motors", "set-baud", "virtual:forgetful", "damiao_mit:1", "5000000")
    assert done.returncode == 3 and "can_br reads 0, not 9" in done.stderr


def test_makers_tools_are_named_where_they_are_needed(motors):
    call = motors("planar2r")
    done = call("zero", "moteus:1")
    assert done.returncode == 3 and "moteus_tool" in done.stderr
    done = call("set-baud", "moteus:1", "1000000")
    assert done.returncode == 3 and "use its maker's tool" in done.stderr


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["scan", "telepathy:0"], "virtual:NAME"),
        (
            ["show", "virtual:nobody", "damiao:3"],
            "odrive, damiao_mit, robstride, myactuator, moteus, cia402, cubemars",
        ),
        (["show", "virtual:nobody", "moteus:3"], "need --fd"),
        (["zero", "virtual:nobody", "damiao_mit:x"], "1 to 127"),
    ],
)
def test_wrong_words(limber, words, said):
    done = limber("motors", *words)
    assert done.returncode == 2 and said in done.stderr


def test_an_empty_bus(limber):
    done = limber("motors", "scan", "virtual:nobody")
    assert done.returncode == 3 and "no motor answers" in done.stderr


def test_nothing_is_sent_while_somebody_else_sends(motors):
    call = motors("desktop2r")
    torque = can.Message(
        arbitration_id=1, data=b"\x7f\xff\x7f\xf0\0\0\x07\xff", is_extended_id=False
    )
    with sending("desktop2r", torque):
        done = call("set-id", "damiao_mit:1", "5")
    assert done.returncode == 3 and "somebody sends on this bus" in done.stderr
    assert listed(call("scan")) == ["damiao_mit:1", "damiao_mit:2"]


def test_a_motor_that_is_on_is_left_alone(motors):
    call = motors("edulite_a3")
    enable = can.Message(arbitration_id=0x0300FD01, data=bytes(8), is_extended_id=True)
    group = multicast_group("edulite_a3")
    with can.Bus(interface="udp_multicast", channel=group, hop_limit=0) as bus:
        bus.send(enable)
    done = call("zero", "robstride:1")
    assert done.returncode == 3 and "its power stage is on" in done.stderr


def test_heartbeats_and_reports_are_not_somebody(motors):
    call = motors("edulite_a3")
    report = can.Message(
        arbitration_id=0x188001FD,
        data=struct.pack(">4H", 0x7FFF, 0x7FFF, 0x7FFF, 300),
        is_extended_id=True,
    )
    with sending("edulite_a3", report):
        assert call("scan").returncode == 0
