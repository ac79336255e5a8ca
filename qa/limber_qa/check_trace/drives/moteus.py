"""moteus drives: rows of subframes `opcode, [count], register, values`, angles in turns."""

import math
import struct
from collections.abc import Iterator

from limber_qa.check_trace.arm import Motor, TURN_rad
from limber_qa.check_trace.candump import Frame, Trace
from limber_qa.check_trace.events import Command, Kind, State, kind_of

TELLS_HOLD = True
FORMATS = "bhif"  # int8, int16, int32, float32
SIZES = (1, 2, 4, 4)
WRITE, READ, REPLY = 0x00, 0x10, 0x20
NOP = 0x50
TEXT = (0x40, 0x41, 0x42)  # the diagnostic channel
MODE, POSITION, VELOCITY = 0x000, 0x001, 0x002
COMMAND = range(0x020, 0x028)  # position, velocity, torque, kp, kd, max torque, stop, watchdog
STOPPED, ENABLING, POSITION_MODE = 0, range(2, 5), 10
FLOAT = 3
Values = dict[int, float]


def resolution_Nm(_motor: Motor) -> float:
    """Of torque: float32."""
    return 1e-6


def commands(motor: Motor, trace: Trace) -> list[Command]:
    frames = trace.of(motor.interface, _command_id(motor.number))
    return [_command(motor, frame) for frame in frames]


def states(motor: Motor, trace: Trace) -> list[State]:
    found = []
    number = motor.number << 8
    key = number if number <= 0x7FF else number | Trace.EXTENDED
    for frame in trace.of(motor.interface, key):
        try:
            values = dict(_registers(frame.data, REPLY))
        except ValueError:
            continue
        if not {MODE, POSITION, VELOCITY} <= values.keys():
            continue
        mode = int(values[MODE])
        speed = motor.sign * values[VELOCITY] * TURN_rad
        found.append(
            State(
                frame.time_ns,
                motor.sign * (values[POSITION] * TURN_rad - motor.offset),
                speed,
                speed,
                mode == POSITION_MODE,
                mode not in (POSITION_MODE, STOPPED, *ENABLING),
            )
        )
    return found


def _command_id(number: int) -> int:
    return 0x8000 | number | Trace.EXTENDED


def _command(motor: Motor, frame: Frame) -> Command:
    time_ns = frame.time_ns
    if frame.remote or not frame.fd:
        return Command(time_ns, Kind.INVALID, text="no CAN-FD data frame")
    try:
        written = list(_registers(frame.data, WRITE))
    except ValueError as error:
        return Command(time_ns, Kind.INVALID, text=str(error))
    values = dict(written)
    if not values:
        return Command(time_ns, Kind.REQUEST)
    if written[0][0] != MODE:
        return Command(time_ns, Kind.INVALID, text="the mode is not written first")
    if values[MODE] == STOPPED:
        return Command(time_ns, Kind.DISABLE)
    if values[MODE] != POSITION_MODE:
        return Command(time_ns, Kind.INVALID, text=f"mode {values[MODE]:g}")
    # What a command leaves out has the drive's default.
    turns, turns_per_s, torque, kp_scale, kd_scale = (
        values.get(register, default)
        for register, default in zip(COMMAND, (0.0, 0.0, 0.0, 1.0, 1.0), strict=False)
    )
    gains = motor.keys["pid_position"]
    kp = kp_scale * gains["kp_Nm_per_turn"] / TURN_rad
    kd = kd_scale * gains["kd_Nms_per_turn"] / TURN_rad
    holds_nothing = math.isnan(turns) and kp_scale == 0.0
    return Command(
        time_ns,
        kind_of(kp, kd, torque, resolution_Nm(motor)),
        motor.sign * torque,
        0.0 if holds_nothing else motor.sign * (turns * TURN_rad - motor.offset),
        motor.sign * turns_per_s * TURN_rad,
        kp,
        kd,
    )


def _registers(data: bytes, wanted: int) -> Iterator[tuple[int, float]]:
    """Registers and values of the subframes of one sort. Raises ValueError."""
    at = 0
    while at < len(data):
        opcode = data[at]
        at += 1
        if opcode == NOP:
            continue
        if opcode in TEXT:
            _, at = _varuint(data, at)
            size, at = _varuint(data, at)
            at += 0 if opcode == 0x42 else size
            continue
        sort, form, count = opcode & 0xF0, opcode >> 2 & 3, opcode & 3
        if sort not in (WRITE, READ, REPLY):
            raise ValueError(f"no subframe begins with {opcode:#04x}")
        if count == 0:
            count, at = _varuint(data, at)
        first, at = _varuint(data, at)
        if sort == READ:
            continue
        if at + count * SIZES[form] > len(data):
            raise ValueError("a subframe ends behind its frame")
        values = struct.unpack_from(f"<{count}{FORMATS[form]}", data, at)
        at += count * SIZES[form]
        if sort != wanted:
            continue
        for register, value in enumerate(values, first):
            if form != FLOAT and (register in COMMAND or register in (POSITION, VELOCITY)):
                raise ValueError("a scaled integer, which limber never sends")
            yield register, value


def _varuint(data: bytes, at: int) -> tuple[int, int]:
    value = shift = 0
    while at < len(data):
        value |= (data[at] & 0x7F) << shift
        shift += 7
        at += 1
        if data[at - 1] < 0x80:
            return value, at
    raise ValueError("a subframe ends behind its frame")
