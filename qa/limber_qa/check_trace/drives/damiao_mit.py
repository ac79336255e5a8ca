"""Damiao drives in MIT mode: five unsigned fields in eight bytes, most significant bit first."""

from limber_qa.check_trace.arm import Motor
from limber_qa.check_trace.candump import Frame, Trace
from limber_qa.check_trace.events import Command, Kind, State, kind_of

TELLS_HOLD = True
SPECIAL = {0xFC: Kind.ENABLE, 0xFD: Kind.DISABLE, 0xFE: Kind.INVALID, 0xFB: Kind.REQUEST}
ENABLED, DISABLED = 1, 0
REGISTERS = 0x7FF  # identifier of what asks for registers or for a state; the drive's is in it
STATE_REQUEST = 0xCC
OTHER_MODES = (0x100, 0x200, 0x300)  # commands of the modes with a loop in the drive


def resolution_Nm(motor: Motor) -> float:
    """Of torque."""
    most: float = motor.keys["mit_range"]["torque_Nm"]
    return 2.0 * most / 4095


def commands(motor: Motor, trace: Trace) -> list[Command]:
    ids = (motor.number, *(motor.number + offset for offset in OTHER_MODES))
    found = [_command(motor, frame) for frame in trace.of(motor.interface, ids[0])]
    for number in ids[1:]:
        found += [
            Command(frame.time_ns, Kind.INVALID, text="a command of another mode than MIT")
            for frame in trace.of(motor.interface, number)
        ]
    found += [
        Command(frame.time_ns, Kind.REQUEST)
        for frame in trace.of(motor.interface, REGISTERS)
        if len(frame.data) == 8
        and frame.data[:2] == bytes((motor.number, 0))
        and frame.data[2] == STATE_REQUEST
    ]
    return sorted(found, key=lambda command: command.time_ns)


def states(motor: Motor, trace: Trace) -> list[State]:
    found: list[State] = []
    if motor.reply_id is None:
        return found
    for frame in trace.of(motor.interface, motor.reply_id):
        data = frame.data
        # An answer about a register looks alike: its third byte is the operation.
        if len(data) != 8 or (data[0], data[1], data[2]) in (
            (motor.number, 0, 0x33),
            (motor.number, 0, 0x55),
        ):
            continue
        status = data[0] >> 4
        mit = motor.keys["mit_range"]
        # Firmware truncates: the truth is half a count higher on average.
        angle = _symmetric((data[1] << 8 | data[2]) + 0.5, 16, mit["position_rad"])
        speed = _symmetric((data[3] << 4 | data[4] >> 4) + 0.5, 12, mit["velocity_rad_per_s"])
        found.append(
            State(
                frame.time_ns,
                motor.within_travel(motor.sign * (angle - motor.offset)),
                motor.sign * speed,
                motor.sign * speed,
                status == ENABLED,
                status not in (ENABLED, DISABLED),
            )
        )
    return found


def _command(motor: Motor, frame: Frame) -> Command:
    data, time_ns = frame.data, frame.time_ns
    if frame.remote or len(data) != 8:
        return Command(time_ns, Kind.INVALID, text=f"{len(data)} bytes where a command has 8")
    if frame.fd != motor.fd:
        return Command(time_ns, Kind.INVALID, text="not in the bus's kind of frame")
    if data[:7] == b"\xff" * 7 and data[7] in SPECIAL:
        kind = SPECIAL[data[7]]
        return Command(time_ns, kind, text="sets the zero" if kind is Kind.INVALID else "")
    mit = motor.keys["mit_range"]
    angle = _symmetric(data[0] << 8 | data[1], 16, mit["position_rad"])
    speed = _symmetric(data[2] << 4 | data[3] >> 4, 12, mit["velocity_rad_per_s"])
    kp = ((data[3] & 15) << 8 | data[4]) * mit["kp_Nm_per_rad"] / 4095
    kd = (data[5] << 4 | data[6] >> 4) * mit["kd_Nms_per_rad"] / 4095
    torque = _symmetric((data[6] & 15) << 8 | data[7], 12, mit["torque_Nm"])
    return Command(
        time_ns,
        kind_of(kp, kd, torque, resolution_Nm(motor)),
        motor.sign * torque,
        motor.within_travel(motor.sign * (angle - motor.offset)),
        motor.sign * speed,
        kp,
        kd,
    )


def _symmetric(count: float, bits: int, end: float) -> float:
    """Counts from -end to +end; none of them is zero."""
    return end * (2 * count / float(2**bits - 1) - 1)
