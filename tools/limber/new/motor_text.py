"""Motors and buses of a first robot.yaml, for each kind of drive."""

from math import pi

from limber.new.guesses import (
    MIT_KD,
    MIT_KP,
    MIT_POSITION_rad,
    MotorGuess,
    WINDING_ohm,
    number,
    three,
)

PROTOCOL = {"damiao": "damiao_mit", "moteus": "moteus", "cia402": "cia402"}
JOINTS_A_BUS = {"damiao": 7, "moteus": 3, "cia402": 2}  # at 1 kHz
BUSES_MOST = 4


def bus_names(drives: str, joints: int) -> list[str]:
    """The bus of each joint."""
    count = min(BUSES_MOST, -(-joints // JOINTS_A_BUS[drives]))
    share = -(-joints // count)
    return [f"can{i // share}" for i in range(joints)]


def bus_lines(name: str, drives: str, buses: list[str]) -> list[str]:
    fd = "fd: true, bitrate_bps: 1000000, data_bitrate_bps: 5000000"
    speed = "bitrate_bps: 1000000" if drives == "cia402" else fd
    return [
        f'  - {{name: {bus}, can: "virtual:{name}_{bus}", {speed}}}' for bus in dict.fromkeys(buses)
    ]


def motor_lines(motor: MotorGuess, drives: str) -> list[str]:
    unit = "N" if motor.slides else "N m"
    return [
        f"  {motor.name}:",
        f"    protocol: {PROTOCOL[drives]}",
        f"    gear_ratio: {number(motor.gear)} # guess: datasheet",
        f"    rotor_inertia_kgm2: {number(motor.rotor)} # guess: datasheet; before the gear",
        f"    rotor_torque_constant_Nm_per_A: {number(motor.constant)} # guess: datasheet, or "
        "limber identify torque-constant RUN",
        f"    phase_resistance_ohm: {number(WINDING_ohm)} # guess: datasheet, or half of what an "
        "ohmmeter shows between two phases",
        f"    peak_torque_Nm: {number(motor.peak)} # guess: datasheet; at the joint, {unit}",
        *_PROTOCOL_LINES[drives](motor),
    ]


def _damiao(motor: MotorGuess) -> list[str]:
    ranges = {
        "position_rad": MIT_POSITION_rad,
        "velocity_rad_per_s": three(max(1.5 * motor.velocity, 1.0)),
        "torque_Nm": three(1.1 * motor.peak),
        "kp_Nm_per_rad": MIT_KP,
        "kd_Nms_per_rad": MIT_KD,
    }
    text = ", ".join(f"{key}: {number(value)}" for key, value in ranges.items())
    return [
        "    encoder_bits: 14 # guess: datasheet",
        "    # guess: PMAX, VMAX and TMAX as the maker's tool shows them; the driver compares them",
        f"    mit_range: {{{text}}}",
    ]


def _moteus(motor: MotorGuess) -> list[str]:
    kp, kd = (three(2.0 * pi * 1.01 * gain) for gain in (motor.kp, motor.kd))
    return [
        "    encoder_bits: 14 # guess: datasheet",
        "    # guess: servo.pid_position.kp and .kd as moteus_tool reads them",
        f"    pid_position: {{kp_Nm_per_turn: {number(kp)}, kd_Nms_per_turn: {number(kd)}}}",
    ]


def _cia402(motor: MotorGuess) -> list[str]:
    return [
        "    encoder_bits: 20 # guess: object 608Fh times the gear 6091h, per turn of the joint",
        f"    rated_torque_Nm: {number(three(motor.peak / 30.0))} # guess: object 6076h, at the "
        "joint",
    ]


_PROTOCOL_LINES = {"damiao": _damiao, "moteus": _moteus, "cia402": _cia402}
