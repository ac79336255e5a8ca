"""RobStride drives, private protocol: type, sixteen bits of data and target in the identifier.

Positions, speeds and torques are counted from -32767 to 32767, gains from 0 to 65535, most
significant byte first.
"""

from math import pi

from limber_qa.check_trace.arm import Motor
from limber_qa.check_trace.candump import Frame, Trace
from limber_qa.check_trace.events import Command, Kind, State, kind_of

TELLS_HOLD = True
CONTROL, STATE, ENABLE, STOP, SET_ZERO, SET_ID, READ, WRITE = 1, 2, 3, 4, 6, 7, 17, 18
PING = 0
REQUESTS = (PING, READ, WRITE)
SPEED, TORQUE, KP, KD = range(4)
# rad/s, N m, N m/rad, N m s/rad at the end of each field, by the manuals of 2026-04
MODELS = {
    "RS00": (33, 14, 500, 5),
    "RS01": (44, 17, 500, 5),
    "RS02": (44, 17, 500, 5),
    "RS03": (20, 60, 5000, 100),
    "RS04": (15, 120, 5000, 100),
    "RS05": (50, 5.5, 500, 5),
    "RS06": (50, 36, 5000, 100),
    "EL05": (50, 6, 500, 5),
    "CyberGear": (30, 12, 500, 5),
}
MOST_RAD = 4 * pi
RUNNING = 2


def resolution_Nm(motor: Motor) -> float:
    """Of torque."""
    return _ends(motor)[TORQUE] / 32767


def commands(motor: Motor, trace: Trace) -> list[Command]:
    return [
        _command(motor, number, frame)
        for number, frame in trace.among(motor.interface, motor.number, 0xFF)
    ]


def states(motor: Motor, trace: Trace) -> list[State]:
    ends = _ends(motor)
    found = []
    for number, frame in trace.among(motor.interface, motor.number << 8, 0xFF00):
        data = frame.data
        if number >> 24 != STATE or number & 0xFF <= 0x7F or len(data) != 8:
            continue
        # Firmware truncates: the truth is half a count higher on average.
        angle = _symmetric(data[0:2], MOST_RAD, 0.5)
        speed = motor.sign * _symmetric(data[2:4], ends[SPEED], 0.5)
        faults, mode = number >> 16 & 0x3F, number >> 22 & 3
        found.append(
            State(
                frame.time_ns,
                motor.within_travel(motor.sign * (angle - motor.offset)),
                speed,
                speed,
                mode == RUNNING and not faults,
                bool(faults),
            )
        )
    return found


def _command(motor: Motor, number: int, frame: Frame) -> Command:
    data, time_ns, kind = frame.data, frame.time_ns, number >> 24
    if frame.remote or frame.fd or len(data) != 8:
        return Command(time_ns, Kind.INVALID, text="not a classic frame of eight bytes")
    if kind in REQUESTS:
        return Command(time_ns, Kind.REQUEST)
    if kind == ENABLE:
        return Command(time_ns, Kind.ENABLE)
    if kind == STOP:
        return Command(time_ns, Kind.DISABLE)
    if kind != CONTROL:
        return Command(time_ns, Kind.INVALID, text=f"a frame of type {kind}")
    ends = _ends(motor)
    torque = ends[TORQUE] * ((number >> 8 & 0xFFFF) - 32767) / 32767
    kp = int.from_bytes(data[4:6], "big") * ends[KP] / 65535
    kd = int.from_bytes(data[6:8], "big") * ends[KD] / 65535
    return Command(
        time_ns,
        kind_of(kp, kd, torque, resolution_Nm(motor)),
        motor.sign * torque,
        motor.within_travel(motor.sign * (_symmetric(data[0:2], MOST_RAD) - motor.offset)),
        motor.sign * _symmetric(data[2:4], ends[SPEED]),
        kp,
        kd,
    )


def _ends(motor: Motor) -> tuple[float, float, float, float]:
    speed, torque, kp, kd = MODELS[motor.keys["model"]]
    own = motor.keys.get("firmware_range", {})
    return (own.get("velocity_rad_per_s", speed), own.get("torque_Nm", torque), kp, kd)


def _symmetric(two: bytes, end: float, more: float = 0.0) -> float:
    return end * (int.from_bytes(two, "big") + more - 32767) / 32767
