"""A driver of your own on python-can: one simulated motor of `limber sim desktop2r`, held softly.

The bytes are written out, so that they can be compared with those of your own encoder.
"""

import struct
import sys
import time

import can

GROUP = sys.argv[1] if len(sys.argv) > 1 else "239.74.21.254"  # `limber sim` prints it
POSITION_RAD, VELOCITY_RAD_PER_S, TORQUE_NM, KP, KD = 12.5, 30.0, 10.0, 500.0, 5.0
ENABLE, DISABLE = bytes.fromhex("FFFFFFFFFFFFFFFC"), bytes.fromhex("FFFFFFFFFFFFFFFD")


def counts(value: float, low: float, high: float, bits: int) -> int:
    return round((value - low) / (high - low) * (2**bits - 1))


def command(position: float, kp: float, kd: float) -> bytes:
    """MIT: 16 bits of position, then 12 each of velocity, kp, kd and torque."""
    p = counts(position, -POSITION_RAD, POSITION_RAD, 16)
    v = counts(0.0, -VELOCITY_RAD_PER_S, VELOCITY_RAD_PER_S, 12)
    gains = counts(kp, 0.0, KP, 12) << 24 | counts(kd, 0.0, KD, 12) << 12
    return struct.pack(">Q", p << 48 | v << 36 | gains | counts(0.0, -TORQUE_NM, TORQUE_NM, 12))


def position(data: bytes) -> float:
    return struct.unpack_from(">H", data, 1)[0] / 65535 * 2 * POSITION_RAD - POSITION_RAD


def exchange(bus: can.BusABC, motor: int, data: bytes) -> bytes:
    """Sends, and returns the motor's answer; on a virtual bus the own frame comes first."""
    bus.send(can.Message(arbitration_id=motor, is_extended_id=False, data=data))
    end = time.monotonic() + 1.0
    while (left := end - time.monotonic()) > 0:
        answer = bus.recv(left)
        if answer is not None and answer.arbitration_id == 0x10 + motor:
            return bytes(answer.data)
    raise SystemExit("the motor does not answer: is `limber sim desktop2r` running?")


with can.Bus(interface="udp_multicast", channel=GROUP, port=43113, hop_limit=0) as bus:
    start = {motor: position(exchange(bus, motor, ENABLE)) for motor in (1, 2)}
    for cycle in range(200):
        for motor in (1, 2):
            now = position(exchange(bus, motor, command(start[motor], kp=40.0, kd=1.0)))
            if cycle % 50 == 49:
                print(f"motor {motor}: {now - start[motor]:+.3f} rad from its start")
        time.sleep(0.01)
    for motor in (1, 2):
        exchange(bus, motor, DISABLE)
