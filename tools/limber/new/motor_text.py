"""Motors and buses of a first robot.yaml, for each kind of drive."""

from limber.model.protocols import Key, Protocol
from limber.new.guesses import MotorGuess, WINDING_ohm, number, three

BUSES_MOST = 4


def bus_names(drives: Protocol, joints: int) -> list[str]:
    """The bus of each joint."""
    count = min(BUSES_MOST, -(-joints // drives.joints_a_bus))
    share = -(-joints // count)
    return [f"can{i // share}" for i in range(joints)]


def bus_lines(name: str, drives: Protocol, buses: list[str]) -> list[str]:
    fd = "fd: true, bitrate_bps: 1000000, data_bitrate_bps: 5000000"
    speed = fd if drives.usually_fd else "bitrate_bps: 1000000"
    return [
        f'  - {{name: {bus}, can: "virtual:{name}_{bus}", {speed}}}' for bus in dict.fromkeys(buses)
    ]


def motor_lines(motor: MotorGuess, drives: Protocol) -> list[str]:
    unit = "N" if motor.slides else "N m"
    return [
        f"  {motor.name}:",
        f"    protocol: {drives.word}",
        f"    gear_ratio: {number(motor.gear)} # guess: datasheet",
        f"    rotor_inertia_kgm2: {number(motor.rotor)} # guess: datasheet; before the gear",
        f"    rotor_torque_constant_Nm_per_A: {number(motor.constant)} # guess: datasheet, or "
        "limber identify torque-constant RUN",
        f"    phase_resistance_ohm: {number(WINDING_ohm)} # guess: datasheet, or half of what an "
        "ohmmeter shows between two phases",
        f"    peak_torque_Nm: {number(motor.peak)} # guess: datasheet; at the joint, {unit}",
        *(line for key in drives.keys("motors.*") for line in _key_lines(motor, drives, key)),
    ]


def _key_lines(motor: MotorGuess, drives: Protocol, key: Key) -> list[str]:
    below = drives.keys(f"motors.*.{key.key}")
    if not below:
        return [f"    {key.key}: {_first(motor, key)} # guess: {key.found}"]
    text = ", ".join(f"{entry.key}: {_first(motor, entry)}" for entry in below)
    return [f"    # guess: {key.found}", f"    {key.key}: {{{text}}}"]


def _first(motor: MotorGuess, key: Key) -> str:
    figures = {
        "peak_torque": motor.peak,
        "speed": motor.velocity,
        "hold_kp": motor.kp,
        "hold_kd": motor.kd,
    }
    return key.word or number(three(key.first(figures)))
