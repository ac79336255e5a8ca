"""ODrive axes in CANSimple: identifier node << 5 | message; a torque out, an answer a request.

Turns and torques are the motor's. The heartbeat tells the state, the answer to message 3 errors.
"""

import struct

from limber_qa.check_trace.arm import Motor, TURN_rad
from limber_qa.check_trace.candump import Frame, Trace
from limber_qa.check_trace.events import Command, Kind, State

TELLS_HOLD = False
HEARTBEAT, ERROR, SET_STATE, ESTIMATES, TORQUE, CLEAR = 0x01, 0x03, 0x07, 0x09, 0x0E, 0x18
IDLE, CLOSED_LOOP = 1, 8


def resolution_Nm(motor: Motor) -> float:
    """Of torque: a float32."""
    return 1e-6


def commands(motor: Motor, trace: Trace) -> list[Command]:
    found = [
        _command(motor, frame, message)
        for message in (SET_STATE, TORQUE, CLEAR)
        for frame in _of(motor, trace, message)
    ]
    return sorted(found, key=lambda command: command.time_ns)


def states(motor: Motor, trace: Trace) -> list[State]:
    events = [
        (frame.time_ns, message, frame.data)
        for message in (HEARTBEAT, ERROR, SET_STATE, ESTIMATES)
        for frame in _of(motor, trace, message)
        if len(frame.data) == (4 if message == SET_STATE else 8)
    ]
    found: list[State] = []
    enabled, failed = True, False  # a trace may begin while it is on
    turn_rad = TURN_rad / motor.keys["gear_ratio"]
    for time_ns, message, data in sorted(events):
        if message == HEARTBEAT:
            enabled = data[4] == CLOSED_LOOP
        elif message == SET_STATE:
            enabled = False  # until it tells
        elif message == ERROR:
            failed = any(data)
        else:
            position, velocity = struct.unpack("<ff", data)
            speed = motor.sign * velocity * turn_rad
            angle = motor.sign * (position * turn_rad - motor.offset)
            found.append(State(time_ns, angle, speed, speed, enabled and not failed, failed))
    return found


def _of(motor: Motor, trace: Trace, message: int) -> list[Frame]:
    frames = trace.of(motor.interface, motor.number << 5 | message)
    return [frame for frame in frames if not frame.remote]


def _command(motor: Motor, frame: Frame, message: int) -> Command:
    if message == CLEAR:
        return Command(frame.time_ns, Kind.ENABLE)
    if len(frame.data) != 4:
        text = f"{len(frame.data)} bytes where a command has 4"
        return Command(frame.time_ns, Kind.INVALID, text=text)
    if message == SET_STATE:
        (state,) = struct.unpack("<I", frame.data)
        kinds = {IDLE: Kind.DISABLE, CLOSED_LOOP: Kind.ENABLE}
        return Command(frame.time_ns, kinds.get(state, Kind.INVALID), text=f"state {state}")
    (torque,) = struct.unpack("<f", frame.data)
    return Command(frame.time_ns, Kind.FOLLOW, motor.sign * torque * motor.keys["gear_ratio"])
