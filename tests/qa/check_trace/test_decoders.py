"""The trace checker's decoders, byte by byte: the protocols' worked frames, and by hand."""

import math
import struct
from dataclasses import replace

import pytest

from limber.errors import InputError
from limber_qa.check_trace.arm import read_arm
from limber_qa.check_trace.candump import Trace, read_trace
from limber_qa.check_trace.drives import (
    cia402,
    cubemars,
    damiao_mit,
    moteus,
    myactuator,
    odrive,
    robstride,
)
from limber_qa.check_trace.events import Kind
from limber_qa.check_trace.judge import judge

TURN_rad = 2 * math.pi
DM4310 = next(motor for motor in read_arm("openarm").motors if motor.name == "joint5")
IDEAL = read_arm("planar2r").motors[0]
IIWA = read_arm("iiwa14").motors[0]
X8 = read_arm("axol").motors[0]  # 129 N m
RS00 = read_arm("edulite_a3").motors[0]  # 14 N m, 33 rad/s; counts the other way

MODES = ((10, 0), (1, 33), (0, 0))  # and fault


def trace(tmp_path, *frames: str) -> Trace:
    path = tmp_path / "trace.log"
    lines = [f"({k}.000000) can0 {frame}\n" for k, frame in enumerate(frames, 1)]
    path.write_text("".join(lines), encoding="ascii")
    return read_trace(path)


def on_can0(motor, **changes):
    return replace(motor, interface="can0", **changes)


def test_damiao_command(tmp_path):
    """p 1.0, v -2.0, kp 60, kd 1.5, t 2.5 truncated: half a count low on average."""
    motor = on_can0(DM4310, number=3, fd=False)
    (command,) = damiao_mit.commands(motor, trace(tmp_path, "003#8A3C7771EB4CC9FF"))
    assert command.kind is Kind.HOLD
    assert command.position == pytest.approx(1.0, abs=25 / 65535)
    assert command.velocity == pytest.approx(-2.0, abs=60 / 4095)
    assert (command.kp, command.kd) == pytest.approx((60, 1.5), abs=500 / 4095)
    assert command.torque == pytest.approx(2.5, abs=20 / 4095)


def test_damiao_sign_and_offset(tmp_path):
    motor = on_can0(DM4310, number=3, fd=False, sign=-1.0, offset=0.25)
    (command,) = damiao_mit.commands(motor, trace(tmp_path, "003#8A3C7771EB4CC9FF"))
    assert command.torque == pytest.approx(-2.5, abs=20 / 4095)
    assert command.position == pytest.approx(-0.75, abs=25 / 65535)


def test_damiao_replies(tmp_path):
    """Enabled; the same after a loss of communication; an answer about a register is no state."""
    motor = on_can0(DM4310, number=3, reply_id=0x13)
    frames = ("013#1387AD7DD9702926", "013#D387AD7FF7FF2926", "013#0300331700002041")
    good, lost = damiao_mit.states(motor, trace(tmp_path, *frames))
    assert (good.enabled, good.failed) == (True, False)
    assert good.position == pytest.approx(0.75, abs=25 / 65535)
    assert good.velocity == pytest.approx(-0.5, abs=60 / 4095)
    assert (lost.enabled, lost.failed) == (False, True)


def test_damiao_register_reads_are_no_commands(tmp_path):
    """While a drive is on, its settings are read beside its commands."""
    motor = on_can0(DM4310, number=3, fd=False)
    frames = ("7FF#0300330A00000000", "7FF#0300CC0000000000", "7FF#0400CC0000000000")
    (request,) = damiao_mit.commands(motor, trace(tmp_path, *frames))
    assert (request.kind, request.time_ns) == (Kind.REQUEST, 2_000_000_000)


def moteus_frame(*values: float) -> str:
    """Mode 10, six values from register 20h on, NOPs up to a length that FD has."""
    data = bytes([0x01, 0x00, 10, 0x0C, len(values), 0x20]) + struct.pack(
        f"<{len(values)}f", *values
    )
    return data.ljust(32, b"\x50").hex().upper()


def test_robstride_command(tmp_path):
    """p 1.0, v -2.0, kp 60, kd 1.5, t 2.5 of 14 N m, in counts of 32767 and 65535."""
    motor = on_can0(RS00)
    frames = ("0196DB01#8A2F783D1EB84CCC", "017FFF01#7FFF7FFF00004CCC", "017FFF02#7FFF7FFF00000000")
    hold, damp = robstride.commands(motor, trace(tmp_path, *frames))
    assert hold.kind is Kind.HOLD
    assert hold.position == pytest.approx(-1.0, abs=4 * math.pi / 32767)
    assert hold.velocity == pytest.approx(2.0, abs=33 / 32767)
    assert (hold.kp, hold.kd) == pytest.approx((60, 1.5), abs=500 / 65535)
    assert hold.torque == pytest.approx(-2.5, abs=14 / 32767)
    assert damp.kind is Kind.DAMP and damp.torque == 0.0


@pytest.mark.parametrize(
    ("frame", "kind"),
    [
        ("017FFF01#7FFF7FFF00000000", Kind.FOLLOW),
        ("0300FD01#0000000000000000", Kind.ENABLE),
        ("0400FD01#0000000000000000", Kind.DISABLE),
        ("1100FD01#2870000000000000", Kind.REQUEST),
        ("0600FD01#0100000000000000", Kind.INVALID),
        ("017FFF01#7FFF7FFF000000", Kind.INVALID),
        ("0300FD01##00000000000000000", Kind.INVALID),
    ],
)
def test_robstride_kinds(tmp_path, frame, kind):
    (command,) = robstride.commands(on_can0(RS00), trace(tmp_path, frame))
    assert command.kind is kind


def test_robstride_states(tmp_path):
    """Running; stopped with a fault; answers about parameters and reports are no states."""
    motor = on_can0(RS00)
    frames = (
        "028001FD#87A27E0F8D8C0181",
        "020201FD#7FFF7FFF7FFF0181",
        "110001FD#2870000090010000",
        "188001FD#7FFF7FFF7FFF0181",
        "028002FD#7FFF7FFF7FFF0181",
    )
    good, failed = robstride.states(motor, trace(tmp_path, *frames))
    assert (good.enabled, good.failed) == (True, False)
    assert good.position == pytest.approx(-0.75, abs=4 * math.pi / 32767)
    assert good.velocity == pytest.approx(0.5, abs=33 / 32767)
    assert (failed.enabled, failed.failed) == (False, True)


X8_V42 = replace(X8, keys={"firmware": "V4.2", "model": "X8"})
X6_V44 = replace(X8, keys={"firmware": "V4.4", "model": "X6"})


@pytest.mark.parametrize(
    ("drive", "frame", "count_Nm", "kd"),
    [(X8_V42, "401#8A3C7A41EB4CC8D4", 24, 5), (X6_V44, "401#8A2F7A41EB07A854", 60, 50)],
)
def test_myactuator_command(tmp_path, drive, frame, count_Nm, kd):
    """p 1.0, v -2.0, kp 60, kd 1.5, t 2.5 truncated, in the ranges of either firmware."""
    motor = on_can0(drive)
    frames = (frame, "401#7FFF7FF0004CC7FF", "402#7FFF7FF0000007FF")
    hold, damp = myactuator.commands(motor, trace(tmp_path, *frames))
    assert hold.kind is Kind.HOLD
    assert hold.position == pytest.approx(1.0, abs=26 / 65535)
    assert hold.velocity == pytest.approx(-2.0, abs=90 / 4095)
    assert hold.kp == pytest.approx(60, abs=500 / 4095)
    assert hold.kd == pytest.approx(1.5, abs=kd / 4095)
    assert hold.torque == pytest.approx(2.5, abs=2 * count_Nm / 4095)
    assert damp.kind is Kind.DAMP


@pytest.mark.parametrize(
    ("frame", "kind"),
    [
        ("401#7FFF7FF0000007FF", Kind.FOLLOW),
        ("141#7700000000000000", Kind.ENABLE),
        ("141#8000000000000000", Kind.DISABLE),
        ("141#9A00000000000000", Kind.REQUEST),
        ("141#B300000014000000", Kind.REQUEST),
        ("141#A100000064000000", Kind.INVALID),
        ("401#7FFF7FF0000007", Kind.INVALID),
        ("141##17700000000000000", Kind.INVALID),
    ],
)
def test_myactuator_kinds(tmp_path, frame, kind):
    (command,) = myactuator.commands(on_can0(X8), trace(tmp_path, frame))
    assert command.kind is kind


def test_myactuator_states(tmp_path):
    """The manual's state, off, before the brake is released, after it, in error, and timed out."""
    state = "501#01E66582EB550000"
    frames = (
        *("241#8000000000000000", state, "241#7700000000000000", state),
        *("241#9A1E0001E0010400", state),
        *("241#9A1E0001E0010000", "241#F100000000000000", state, "502#02E66582EB550000"),
    )
    found = myactuator.states(on_can0(X8_V42), trace(tmp_path, *frames))
    assert [one.enabled for one in found] == [False, True, False, False]
    assert [one.failed for one in found] == [False, False, True, True]
    assert found[0].position == pytest.approx(10, abs=1e-3)
    assert found[0].velocity == pytest.approx(1.032, abs=1e-3)


AK60_6 = read_arm("desktop2r_ak").motors[0]
AK80_9 = replace(
    AK60_6, number=2, keys={"model": "AK80-9", "board": "V2", "gear_ratio": 9, "keeps_turns": True}
)
AK10_9 = replace(AK80_9, number=0x68, keys=AK80_9.keys | {"model": "AK10-9", "board": "V3"})


@pytest.mark.parametrize(
    ("drive", "frame", "expected"),
    [
        (AK80_9, "002#77CE87A0CC28F621", (-0.8, 3, 25, 0.8, -4.2)),
        (AK10_9, "00000868#1EB4CC8A3076D85E", (1, -2, 60, 1.5, 2.5)),
    ],
)
def test_cubemars_command(tmp_path, drive, frame, expected):
    (hold,) = cubemars.commands(on_can0(drive), trace(tmp_path, frame))
    assert hold.kind is Kind.HOLD
    assert hold.position == pytest.approx(expected[0], abs=26 / 65535)
    assert hold.velocity == pytest.approx(expected[1], abs=100 / 4095)
    assert hold.kp == pytest.approx(expected[2], abs=500 / 4095)
    assert hold.kd == pytest.approx(expected[3], abs=5 / 4095)
    assert hold.torque == pytest.approx(expected[4], abs=cubemars.resolution_Nm(drive))


@pytest.mark.parametrize(
    ("drive", "frame", "kind"),
    [
        (AK80_9, "002#7FFF7FF0000007FF", Kind.FOLLOW),
        (AK80_9, "002#FFFFFFFFFFFFFFFC", Kind.ENABLE),
        (AK80_9, "002#FFFFFFFFFFFFFFFD", Kind.DISABLE),
        (AK80_9, "002#FFFFFFFFFFFFFFFE", Kind.INVALID),
        (AK80_9, "002#FFFFFFFFFFFF0000", Kind.INVALID),
        (AK80_9, "002#7FFF7FF0000007", Kind.INVALID),
        (AK10_9, "00000868#0000007FFF7FF7FF", Kind.FOLLOW),
        (AK10_9, "00000168#00000000", Kind.DISABLE),
        (AK10_9, "00000168#00000001", Kind.INVALID),
        (AK10_9, "00000868#FFFFFFFFFFFFFFFD", Kind.INVALID),
    ],
)
def test_cubemars_kinds(tmp_path, drive, frame, kind):
    (command,) = cubemars.commands(on_can0(drive), trace(tmp_path, frame))
    assert command.kind is kind


def test_cubemars_states(tmp_path):
    """Whose they are tells the first byte, whether it is on what it was told."""
    state = "000#0277CE87A6212400"
    frames = (state, "002#FFFFFFFFFFFFFFFD", state, "002#7FFF7FF0000007FF", state)
    frames += ("002#FFFFFFFFFFFFFFFC", state, "000#0377CE87A6212400", "000#0277CE87A6212402")
    found = cubemars.states(on_can0(AK80_9), trace(tmp_path, *frames))
    assert [one.enabled for one in found] == [True, False, False, True, False]
    assert [one.failed for one in found] == [False] * 4 + [True]
    assert found[0].position == pytest.approx(-0.8, abs=25 / 65535)
    assert found[0].velocity == pytest.approx(3, abs=100 / 4095)
    (of_v3,) = cubemars.states(on_can0(AK10_9), trace(tmp_path, "00002968#0384FF9C00961F00"))
    assert of_v3.position == pytest.approx(math.pi / 2)
    assert of_v3.velocity == pytest.approx(-1000 / 60 * TURN_rad / 189)


def test_moteus_command(tmp_path):
    frame = moteus_frame(0.25, -0.5, 3.0, 0.5, 1.0, 20.0)
    (command,) = moteus.commands(on_can0(IDEAL), trace(tmp_path, f"00008001##1{frame}"))
    assert command.kind is Kind.HOLD
    assert command.torque == 3.0
    assert command.position == pytest.approx(0.25 * TURN_rad)
    assert command.velocity == pytest.approx(-0.5 * TURN_rad)
    assert (command.kp, command.kd) == pytest.approx((2000 / TURN_rad, 200 / TURN_rad))


@pytest.mark.parametrize(
    ("data", "kind"),
    [
        (moteus_frame(math.nan, 0.0, 3.0, 0.0, 0.0, 20.0), Kind.FOLLOW),
        (moteus_frame(math.nan, 0.0, 0.0, 0.0, 1.0, 20.0), Kind.DAMP),
        ("0100005050505050", Kind.DISABLE),  # mode 0
        ("1100505050505050", Kind.REQUEST),  # reads the mode
        ("0D20000000005050", Kind.INVALID),  # a position without a mode
        ("01000F5050505050", Kind.INVALID),  # mode 15
        ("99", Kind.INVALID),
        ("0C0620000000", Kind.INVALID),  # six values that are not there
    ],
)
def test_moteus_kinds(tmp_path, data, kind):
    (command,) = moteus.commands(on_can0(IDEAL), trace(tmp_path, f"00008001##1{data}"))
    assert command.kind is kind


@pytest.mark.parametrize("torque", [math.nan, math.inf, -math.inf])
def test_what_is_not_finite_is_a_breach(tmp_path, torque):
    arm = replace(read_arm("planar2r"), motors=[on_can0(IDEAL)])
    frame = moteus_frame(math.nan, 0.0, torque, 0.0, 0.0, 20.0)
    verdict = judge(trace(tmp_path, f"00008001##1{frame}"), arm)
    assert "finite" in {breach.rule for breach in verdict.breaches}


def test_moteus_states(tmp_path):
    """Mode as int8, four floats from register 1 on, temperature and fault as int8."""
    measured = struct.pack("<4f", 0.25, -1.0, 2.0, 0.5).hex()
    frames = [f"100##12100{mode:02X}2C0401{measured}220E1E{fault:02X}" for mode, fault in MODES]
    good, failed, stopped = moteus.states(on_can0(IDEAL), trace(tmp_path, *frames))
    assert (good.enabled, good.failed) == (True, False)
    assert good.position == pytest.approx(0.25 * TURN_rad)
    assert good.velocity == pytest.approx(-TURN_rad)
    assert (failed.enabled, failed.failed) == (False, True)
    assert (stopped.enabled, stopped.failed) == (False, False)


def test_cia402_command(tmp_path):
    """Enable, 200 thousandths of 28 N m; a torque without the enabling word is none."""
    motor = on_can0(IIWA, number=3, keys={"rated_torque_Nm": 28.0}, sign=1.0)
    frames = ("203#0F00C800", "203#0600C800", "203#06000000", "203#00000000", "203#0F00C8")
    found = cia402.commands(motor, trace(tmp_path, *frames))
    assert found[0].torque == pytest.approx(5.6)
    kinds = [command.kind for command in found]
    assert kinds == [Kind.FOLLOW, Kind.INVALID, Kind.ENABLE, Kind.DISABLE, Kind.INVALID]


def test_cia402_states_on_a_classic_bus(tmp_path):
    """Statusword and angle in one frame, speed and torque in the next: 81920 counts of 327680."""
    motor = on_can0(
        IIWA,
        number=3,
        fd=False,
        torque_sensor=False,
        link_counts_per_turn=None,
        counts_per_turn=327680.0,
        sign=-1.0,
        offset=0.0,
    )
    frames = ("183#371600400100", "283#00C0FEFFF1FF", "183#081600400100", "283#000000000000")
    good, failed = cia402.states(motor, trace(tmp_path, *frames))
    assert good.position == pytest.approx(-TURN_rad / 4)
    assert good.velocity == pytest.approx(TURN_rad / 4)
    assert (good.enabled, good.failed) == (True, False)
    assert (failed.enabled, failed.failed) == (False, True)


def test_cia402_states_of_a_link_encoder(tmp_path):
    data = struct.pack("<Hiihhii", 0x1637, 1, 2, 3, 4, 1 << 18, -(1 << 17)).ljust(24, b"\0")
    motor = on_can0(IIWA, number=3, fd=True, link_counts_per_turn=2.0**20, sign=-1.0)
    (state,) = cia402.states(motor, trace(tmp_path, f"183##1{data.hex()}"))
    assert state.position == pytest.approx(TURN_rad / 4)
    assert state.velocity == pytest.approx(-TURN_rad / 8)
    assert state.motor_velocity == pytest.approx(-2 * TURN_rad / IIWA.counts_per_turn)


@pytest.mark.parametrize(
    "line", ["hello", "(1.0) can0 001", "1.0 can0 001#00", "(1.0) can0 001#0", "(1.0) can0 1#00"]
)
def test_a_line_that_is_none_is_named(tmp_path, line):
    path = tmp_path / "trace.log"
    path.write_text(f"(1.0) can0 001#00\n{line}\n", encoding="ascii")
    with pytest.raises(InputError, match=r"trace\.log:2"):
        read_trace(path)


def test_a_trace_of_another_arm_is_refused(tmp_path):
    with pytest.raises(InputError, match="can0"):
        judge(trace(tmp_path, "001#00"), read_arm("openarm"))


S1 = replace(read_arm("desktop2r_odrive").motors[1], sign=-1, offset=0.1)  # geared 8 to 1


@pytest.mark.parametrize(
    ("frame", "kind"),
    [
        ("04E#CDCC4CBE", Kind.FOLLOW),
        ("04E#CDCC4CBE00000000", Kind.INVALID),
        ("047#08000000", Kind.ENABLE),
        ("047#01000000", Kind.DISABLE),
        ("047#03000000", Kind.INVALID),
        ("058#", Kind.ENABLE),
    ],
)
def test_odrive_kinds(tmp_path, frame, kind):
    (command,) = odrive.commands(on_can0(S1), trace(tmp_path, frame, "049#R", "05C#R"))
    assert command.kind is kind
    if kind is Kind.FOLLOW:
        assert command.torque == pytest.approx(1.6)


def test_odrive_states(tmp_path):
    """On until a heartbeat or an order says otherwise; errors have an answer of their own."""
    estimates = "049#87F9A23E0000C0BF"
    frames = ("049#R", estimates, "041#0000000001000100", estimates, "041#0000000008000100")
    frames += (estimates, "043#0000000000040000", estimates, "043#0000000000000000", estimates)
    frames += ("047#01000000", estimates)
    found = odrive.states(on_can0(S1), trace(tmp_path, *frames))
    assert [one.enabled for one in found] == [True, False, True, False, True, False]
    assert [one.failed for one in found] == [False, False, False, True, False, False]
    assert found[0].position == pytest.approx(-(2 / 8 - 0.1), abs=1e-5)
    assert found[0].velocity == pytest.approx(1.5 * TURN_rad / 8)
