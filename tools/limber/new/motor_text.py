"""Motors and buses of a first robot.yaml, for each kind of drive."""

from limber.model.protocols import Key
from limber.new.guesses import MotorGuess, WINDING_ohm, number, three
from limber.new.wiring import Motor

READ = "read from the motor"
EXACT = 15  # digits


def bus_lines(name: str, motors: list[Motor]) -> list[str]:
    lines = {}
    for motor in motors:
        fd = "fd: true, bitrate_bps: 1000000, data_bitrate_bps: 5000000"
        speed = fd if motor.fd else "bitrate_bps: 1000000"
        line = f'  - {{name: {motor.bus}, can: "virtual:{name}_{motor.bus}", {speed}}}'
        lines[motor.bus] = line + (f" # found on {motor.found_on}" if motor.found_on else "")
    return list(lines.values())


def motor_lines(motor: MotorGuess) -> list[str]:
    unit = "N" if motor.slides else "N m"
    drives = motor.wired.drives
    geared = READ if motor.wired.key("motors.*", "gear_ratio") else "guess: datasheet"
    return [
        f"  {motor.name}:",
        f"    protocol: {drives.word}",
        f"    gear_ratio: {number(motor.gear)} # {geared}",
        f"    rotor_inertia_kgm2: {number(motor.rotor)} # guess: datasheet; before the gear",
        f"    rotor_torque_constant_Nm_per_A: {number(motor.constant)} # guess: datasheet, or "
        "limber identify torque-constant RUN",
        f"    phase_resistance_ohm: {number(WINDING_ohm)} # guess: datasheet, or half of what an "
        "ohmmeter shows between two phases",
        f"    peak_torque_Nm: {number(motor.peak)} # guess: datasheet; at the joint, {unit}",
        *(line for key in drives.keys("motors.*") for line in _key_lines(motor, key)),
    ]


def _key_lines(motor: MotorGuess, key: Key) -> list[str]:
    below = motor.wired.drives.keys(f"motors.*.{key.key}")
    if not below:
        text, read = _value(motor, key)
        return [f"    {text} # {READ if read else f'guess: {key.found}'}"]
    values = [_value(motor, entry) for entry in below]
    known = [entry.key for entry, (_, read) in zip(below, values, strict=True) if read]
    comment = f"guess: {key.found}" if not known else f"{', '.join(known)}: {READ}"
    return [f"    # {comment}", f"    {key.key}: {{{', '.join(text for text, _ in values)}}}"]


def _value(motor: MotorGuess, key: Key) -> tuple[str, bool]:
    """ "KEY: VALUE", and whether it was read."""
    read = motor.wired.key(key.section, key.key, *key.others)
    if read is None:
        return f"{key.key}: {_first(motor, key)}", False
    name, value = read
    return f"{name}: {value if isinstance(value, str) else number(value, EXACT)}", True


def _first(motor: MotorGuess, key: Key) -> str:
    figures = {
        "peak_torque": motor.peak,
        "speed": motor.velocity,
        "hold_kp": motor.kp,
        "hold_kd": motor.kd,
    }
    return key.word or number(three(key.first(figures)))
