"""CiA 402 drives in cyclic synchronous torque mode: controlword and torque out, TPDOs back."""

import struct
from collections.abc import Iterator

from limber_qa.check_trace.arm import Motor, TURN_rad
from limber_qa.check_trace.candump import Frame, Trace
from limber_qa.check_trace.events import Command, Kind, State

TELLS_HOLD = False
RPDO1, TPDO1, PDO_STEP = 0x200, 0x180, 0x100
OPERATION_ENABLED, FAULT_BIT, QUICK_STOP_BIT = 0x27, 0x08, 0x20
# Objects by name, in the order of the frames
STATUS, ANGLE, SPEED, TORQUE, CURRENT, LINK_ANGLE, LINK_SPEED = range(7)
FORMATS = "Hiihhii"


def resolution_Nm(motor: Motor) -> float:
    """Of torque: a thousandth of the rated one."""
    rated: float = motor.keys["rated_torque_Nm"]
    return rated / 1000


def commands(motor: Motor, trace: Trace) -> list[Command]:
    frames = trace.of(motor.interface, RPDO1 + motor.number)
    return [_command(motor, frame) for frame in frames]


def states(motor: Motor, trace: Trace) -> list[State]:
    found = []
    for time_ns, values in _whole(motor, trace):
        status = values[STATUS]
        link, turn = LINK_ANGLE in values, motor.counts_per_turn
        if link and motor.link_counts_per_turn is not None:
            turn = motor.link_counts_per_turn
        angle = values[LINK_ANGLE if link else ANGLE] * TURN_rad / turn
        speed = values[LINK_SPEED if link else SPEED] * TURN_rad / turn
        # The link encoder counts as the joint does.
        sign, offset = (1.0, 0.0) if link else (motor.sign, motor.offset)
        enabled = status & 0x6F == OPERATION_ENABLED
        quick_stop = status & 0x6F == 0x07
        found.append(
            State(
                time_ns,
                sign * (angle - offset),
                sign * speed,
                motor.sign * values[SPEED] * TURN_rad / motor.counts_per_turn,
                enabled,
                bool(status & FAULT_BIT) or quick_stop,
            )
        )
    return found


def _layout(motor: Motor) -> list[list[int]]:
    """The objects of each TPDO."""
    link = [LINK_ANGLE, LINK_SPEED] if motor.link_counts_per_turn else []
    if motor.fd:
        return [[STATUS, ANGLE, SPEED, TORQUE, CURRENT, *link]]
    second = [SPEED, TORQUE, CURRENT] if motor.torque_sensor else [SPEED, TORQUE]
    return [[STATUS, ANGLE], second, *([link] if link else [])]


def _whole(motor: Motor, trace: Trace) -> Iterator[tuple[int, dict[int, int]]]:
    """States of which all parts have come, in the order of the TPDOs."""
    layout = _layout(motor)
    ids = [TPDO1 + motor.number + k * PDO_STEP for k in range(len(layout))]
    parts = [
        (frame.time_ns, k, frame.data)
        for k, number in enumerate(ids)
        for frame in trace.of(motor.interface, number)
    ]
    values: dict[int, int] = {}
    for time_ns, k, data in sorted(parts):
        form = "<" + "".join(FORMATS[item] for item in layout[k])
        if len(data) < struct.calcsize(form):
            continue
        if k == 0:
            values = {}
        values.update(zip(layout[k], struct.unpack_from(form, data), strict=True))
        if k == len(layout) - 1 and STATUS in values and SPEED in values:
            yield time_ns, values


def _command(motor: Motor, frame: Frame) -> Command:
    if frame.remote or len(frame.data) != 4:
        text = f"{len(frame.data)} bytes where a command has 4"
        return Command(frame.time_ns, Kind.INVALID, text=text)
    word, permille = struct.unpack("<Hh", frame.data)
    torque = motor.sign * permille * resolution_Nm(motor)
    if word & 0x8F == 0x0F:
        return Command(frame.time_ns, Kind.FOLLOW, torque)
    if permille != 0:
        text = f"torque with controlword {word:04X}h, which does not enable"
        return Command(frame.time_ns, Kind.INVALID, text=text)
    enabling = word & 0x87 in (0x06, 0x07)
    return Command(frame.time_ns, Kind.ENABLE if enabling else Kind.DISABLE)
