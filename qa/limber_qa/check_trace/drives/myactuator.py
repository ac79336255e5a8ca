"""MyActuator drives: motion mode under 400h and 500h + number, orders under 140h and 240h.

The five numbers are unsigned fields, most significant bit first, over ranges of the firmware.
"""

from limber_qa.check_trace.arm import Motor
from limber_qa.check_trace.candump import Frame, Trace
from limber_qa.check_trace.events import Command, Kind, State, kind_of

TELLS_HOLD = True
ORDER, ANSWER, MOTION, STATE = 0x140, 0x240, 0x400, 0x500
OFF, RELEASE, STATUS, TIMED_OUT = 0x80, 0x77, 0x9A, 0xF1
# Angle, version, model; and, set at the start: time-out, and errors told at once.
REQUESTS = (0x92, STATUS, 0xB2, 0xB5, 0xB3, 0x20)
MOST_rad_per_s, MOST_KP = 45, 500
SERIES_Nm = {"X6": 60, "X8": 129}  # from V4.4 on


def resolution_Nm(motor: Motor) -> float:
    """Of torque."""
    return 2.0 * _ranges(motor)[2] / 4095


def commands(motor: Motor, trace: Trace) -> list[Command]:
    found = [_command(motor, frame) for frame in trace.of(motor.interface, MOTION + motor.number)]
    found += [_order(frame) for frame in trace.of(motor.interface, ORDER + motor.number)]
    return sorted(found, key=lambda command: command.time_ns)


def states(motor: Motor, trace: Trace) -> list[State]:
    """Those in answer to motion commands; of errors only the status tells, and of a time-out a
    frame of its own.
    """
    frames = [*trace.of(motor.interface, STATE + motor.number)]
    frames += trace.of(motor.interface, ANSWER + motor.number)
    position, _, _ = _ranges(motor)
    found: list[State] = []
    enabled, failed = True, False  # a trace may begin while it is on
    for frame in sorted(frames, key=lambda frame: frame.time_ns):
        data = frame.data
        if len(data) != 8:
            continue
        if data[0] != motor.number:
            if data[0] == STATUS:
                failed = bool(data[6] or data[7])
            failed = failed or data[0] == TIMED_OUT
            enabled = data[0] == RELEASE or (enabled and data[0] not in (OFF, TIMED_OUT))
            continue
        # Firmware truncates: the truth is half a count higher on average.
        angle = _symmetric((data[1] << 8 | data[2]) + 0.5, 16, position)
        speed = motor.sign * _symmetric((data[3] << 4 | data[4] >> 4) + 0.5, 12, MOST_rad_per_s)
        found.append(
            State(
                frame.time_ns,
                motor.within_travel(motor.sign * (angle - motor.offset)),
                speed,
                speed,
                enabled and not failed,
                failed,
            )
        )
    return found


def _order(frame: Frame) -> Command:
    data, time_ns = frame.data, frame.time_ns
    if frame.remote or frame.fd or len(data) != 8:
        return Command(time_ns, Kind.INVALID, text="not a classic frame of eight bytes")
    if data[0] in REQUESTS:
        return Command(time_ns, Kind.REQUEST)
    if data[0] in (OFF, RELEASE):
        return Command(time_ns, Kind.DISABLE if data[0] == OFF else Kind.ENABLE)
    return Command(time_ns, Kind.INVALID, text=f"order {data[0]:02X}")


def _command(motor: Motor, frame: Frame) -> Command:
    data, time_ns = frame.data, frame.time_ns
    if frame.remote or frame.fd or len(data) != 8:
        return Command(time_ns, Kind.INVALID, text="not a classic frame of eight bytes")
    position, most_kd, most_Nm = _ranges(motor)
    kp = ((data[3] & 15) << 8 | data[4]) * MOST_KP / 4095
    kd = (data[5] << 4 | data[6] >> 4) * most_kd / 4095
    torque = _symmetric((data[6] & 15) << 8 | data[7], 12, most_Nm)
    angle = _symmetric(data[0] << 8 | data[1], 16, position)
    return Command(
        time_ns,
        kind_of(kp, kd, torque, resolution_Nm(motor)),
        motor.sign * torque,
        motor.within_travel(motor.sign * (angle - motor.offset)),
        motor.sign * _symmetric(data[2] << 4 | data[3] >> 4, 12, MOST_rad_per_s),
        kp,
        kd,
    )


def _ranges(motor: Motor) -> tuple[float, float, float]:
    """rad, N m s/rad, N m."""
    if motor.keys["firmware"] == "V4.2":
        return 12.5, 5.0, 24.0
    named = motor.keys.get("firmware_range", {}).get("torque_Nm")
    return 12.566, 50.0, named or SERIES_Nm[motor.keys["model"]]


def _symmetric(count: float, bits: int, end: float) -> float:
    """Counts from -end to +end; none of them is zero."""
    return end * (2 * count / float(2**bits - 1) - 1)
