"""CubeMars drives in MIT mode: five unsigned fields, over ranges that model and board give.

Boards V1 and V2 all reply under one identifier, and the first byte tells who. Boards V3 have 29-bit
identifiers, packet << 8 | number, gains first. No state tells whether a drive is on: what it was
told last does.
"""

import math

from limber_qa.check_trace.arm import Motor
from limber_qa.check_trace.candump import Frame, Trace
from limber_qa.check_trace.events import Command, Kind, State, kind_of

TELLS_HOLD = True
SPECIAL = {0xFC: Kind.ENABLE, 0xFD: Kind.DISABLE}  # as first six bytes FF
V3_CURRENT, V3_MIT, V3_STATE = (Trace.EXTENDED + packet for packet in (0x100, 0x800, 0x2900))
TENTH_rad = math.radians(0.1)
TEN_RPM = 10 * 2 * math.pi / 60
KP, KD = 500.0, 5.0
RANGES = {  # rad, rad/s, N m
    ("AK10-9", "V2"): (12.5, 50, 65),
    ("AK10-9", "V3"): (12.56, 28, 54),
    ("AK60-6", "V2"): (12.5, 50, 15),
    ("AK60-6", "V3"): (12.56, 60, 12),
    ("AK70-10", "V2"): (12.5, 50, 25),
    ("AK80-6", "V1"): (95.5, 45, 18),
    ("AK80-6", "V2"): (12.5, 76, 12),
    ("AK80-64", "V2"): (12.5, 8, 144),
    ("AK80-9", "V2"): (12.5, 50, 18),
}


def resolution_Nm(motor: Motor) -> float:
    """Of torque."""
    return 2.0 * _ranges(motor)[2] / 4095


def commands(motor: Motor, trace: Trace) -> list[Command]:
    if motor.keys["board"] != "V3":
        return [_command(motor, frame) for frame in trace.of(motor.interface, motor.number)]
    found = [_command(motor, frame) for frame in trace.of(motor.interface, V3_MIT + motor.number)]
    for frame in trace.of(motor.interface, V3_CURRENT + motor.number):
        off = frame.data == bytes(4)
        text = "" if off else "a current"
        found.append(Command(frame.time_ns, Kind.DISABLE if off else Kind.INVALID, text=text))
    return sorted(found, key=lambda command: command.time_ns)


def states(motor: Motor, trace: Trace) -> list[State]:
    v3 = motor.keys["board"] == "V3"
    length = 6 if motor.keys["board"] == "V1" else 8
    told = commands(motor, trace)
    found: list[State] = []
    enabled = True  # a trace may begin while it is on
    reply_id = V3_STATE + motor.number if v3 else motor.reply_id or 0
    for frame in trace.of(motor.interface, reply_id):
        data = frame.data
        if len(data) != length or not (v3 or data[0] == motor.number):
            continue
        while told and told[0].time_ns <= frame.time_ns:
            kind = told.pop(0).kind
            enabled = kind is not Kind.DISABLE and (enabled or v3 or kind is Kind.ENABLE)
        angle, speed = _motion(motor, data)
        failed = length == 8 and data[7] != 0
        found.append(
            State(
                frame.time_ns,
                motor.within_travel(motor.sign * (angle - motor.offset)),
                motor.sign * speed,
                motor.sign * speed,
                enabled and not failed,
                failed,
            )
        )
    return found


def _motion(motor: Motor, data: bytes) -> tuple[float, float]:
    if motor.keys["board"] == "V3":
        rpm_count = TEN_RPM / (motor.keys.get("pole_pairs", 21) * motor.keys["gear_ratio"])
        return _signed(data[0:2]) * TENTH_rad, _signed(data[2:4]) * rpm_count
    # Firmware truncates: the truth is half a count higher on average.
    position, velocity, _ = _ranges(motor)
    return (
        _symmetric((data[1] << 8 | data[2]) + 0.5, 16, position),
        _symmetric((data[3] << 4 | data[4] >> 4) + 0.5, 12, velocity),
    )


def _command(motor: Motor, frame: Frame) -> Command:
    data, time_ns = frame.data, frame.time_ns
    if frame.remote or frame.fd or len(data) != 8:
        return Command(time_ns, Kind.INVALID, text="not a classic frame of eight bytes")
    if data[:6] == b"\xff" * 6:
        special = None if motor.keys["board"] == "V3" else SPECIAL.get(data[7])
        return Command(time_ns, special or Kind.INVALID, text="" if special else "six bytes FF")
    bits = int.from_bytes(data, "big")
    widths = (12, 12, 16, 12, 12) if motor.keys["board"] == "V3" else (16, 12, 12, 12, 12)
    fields, left = [], 64
    for width in widths:
        left -= width
        fields.append(bits >> left & 2**width - 1)
    if motor.keys["board"] == "V3":
        kp, kd, p, v, t = fields
    else:
        p, v, kp, kd, t = fields
    position, velocity, most_Nm = _ranges(motor)
    of_kp, of_kd = _gains(motor)
    torque = _symmetric(t, 12, most_Nm)
    return Command(
        time_ns,
        kind_of(kp * of_kp / 4095, kd * of_kd / 4095, torque, resolution_Nm(motor)),
        motor.sign * torque,
        motor.within_travel(motor.sign * (_symmetric(p, 16, position) - motor.offset)),
        motor.sign * _symmetric(v, 12, velocity),
        kp * of_kp / 4095,
        kd * of_kd / 4095,
    )


def _ranges(motor: Motor) -> tuple[float, float, float]:
    """rad, rad/s, N m."""
    named = motor.keys.get("mit_range")
    if named:
        return named["position_rad"], named["velocity_rad_per_s"], named["torque_Nm"]
    return RANGES[motor.keys["model"], motor.keys["board"]]


def _gains(motor: Motor) -> tuple[float, float]:
    """N m/rad, N m s/rad."""
    named = motor.keys.get("mit_range")
    return (named["kp_Nm_per_rad"], named["kd_Nms_per_rad"]) if named else (KP, KD)


def _signed(word: bytes) -> int:
    return int.from_bytes(word, "big", signed=True)


def _symmetric(count: float, bits: int, end: float) -> float:
    """Counts from -end to +end; none of them is zero."""
    return end * (2 * count / float(2**bits - 1) - 1)
