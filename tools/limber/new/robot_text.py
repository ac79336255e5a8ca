"""A first robot.yaml, with a comment at every guess."""

import json
import re
from math import isfinite

from limber.new.facts import ArmFacts
from limber.new.guesses import RATIO, Guesses, JointGuess, number
from limber.new.motor_text import READ, bus_lines, motor_lines
from limber.new.wiring import Motor

HEAD = """\
# {name}: written by `limber new` from {urdf}, for {drives} drives.
#
# It runs in simulation as it is. What the URDF does not tell is marked "guess:", with where the
# true figure is found; replace each before this file drives a motor. All keys: docs/own_arm.md.
format: limber-robot/1
name: {name}
description: first description of {name}, drives guessed
urdf: robot.urdf
base: {base}
tip: {tip}
rate_hz: {rate} # what the buses below carry

# To leave the simulator, change virtual:... to socketcan:can0; limber doctor tells how to bring it
# up.
buses: # guess: which joint is wired to which bus
"""
WATCHDOG = """\

# Written to the drives: without a command for so long they stop by themselves.
# reaction is what the simulated drive does then, damp or off.
watchdog: {timeout_s: 0.02, reaction: damp} # guess: reaction, datasheet
"""
JOINTS = """\

# Signs and offsets: joint angle = sign * (drive angle - offset). Move each joint by hand and
# compare with `limber watch`. hold: what the driver does without a controller. Friction, springs,
# sensors: optional, docs/own_arm.md.
joints:
"""


def plain(text: str) -> str:
    """A name as YAML reads it back."""
    safe = re.fullmatch(r"[A-Za-z_][A-Za-z0-9_./-]*", text)
    words = {"true", "false", "null", "yes", "no", "on", "off", "y", "n"}
    return text if safe and text.lower() not in words else json.dumps(text)


def text(
    name: str, arm: ArmFacts, guesses: Guesses, wired: list[Motor], left: list[Motor], rate: int
) -> str:
    """`wired`: the motor of each joint; `left`: motors that were found and have none."""
    head = HEAD.format(
        name=name,
        urdf=arm.urdf.name,
        drives=" and ".join(dict.fromkeys(motor.drives.title for motor in wired)),
        base=plain(arm.base),
        tip=plain(arm.tip),
        rate=rate,
    )
    motors = [line for motor in guesses.motors for line in motor_lines(motor)]
    joints = []
    for joint, motor, home in zip(guesses.joints, wired, arm.home, strict=True):
        joints += _joint_lines(joint, motor, float(home))
    parts = [
        head + "\n".join([*bus_lines(name, wired), *_left_lines(left)]),
        WATCHDOG,
        "motors:",
        "\n".join(motors) + "\n" + JOINTS.rstrip("\n"),
        "\n".join(joints),
        _gains(guesses),
    ]
    return "\n".join(parts) + "\n"


def _left_lines(left: list[Motor]) -> list[str]:
    if not left:
        return []
    lines = ["", "# Found, but not one a joint. Give each joint its bus, id and motor:"]
    for motor in left:
        keys = "".join(f", {key}: {value}" for key, value in motor.keys.items())
        lines.append(f"#   {motor.word} on {motor.found_on}{keys}")
    return lines


def _joint_lines(joint: JointGuess, motor: Motor, home: float) -> list[str]:
    drives = motor.drives
    rotary = not joint.facts.slides
    unit, force = ("rad", "Nm") if rotary else ("m", "N")
    stiffness, damping = ("Nm_per_rad", "Nms_per_rad") if rotary else ("N_per_m", "Ns_per_m")
    kp, kd = (number(gain) for gain in (joint.hold_kp, joint.hold_kd))
    digits = "0x{:02X}" if drives.hex_ids else "{}"
    order = f"found on {motor.found_on}, joints in order of number"
    found = order if motor.found_on else drives.id_found
    ids = [f"    id: {digits.format(motor.number)} # guess: {found}"]
    for key in drives.keys("joints.*"):
        read = motor.key(key.section, key.key)
        value = digits.format(int(read[1]) if read else motor.number + int(key.least))
        ids.append(f"    {key.key}: {value} # {READ if read else f'guess: {key.found}'}")
    return [
        f"  {plain(joint.facts.name)}:",
        f"    motor: {joint.motor}",
        f"    bus: {motor.bus}",
        *ids,
        "    sign: 1 # guess: -1 if the drive counts the other way",
        f"    offset_{unit}: 0 # guess: drive angle where the URDF's joint is at zero",
        *_limit_lines(joint, unit, force),
        *_rate_lines(joint, force),
        f"    home_{unit}: {number(home)} # guess: a pose without contact, elbow bent",
        "    # guess: firm enough for the weight, without vibration",
        f"    hold: {{kp_{stiffness}: {kp}, kd_{damping}: {kd}}}",
    ]


def _limit_lines(joint: JointGuess, unit: str, force: str) -> list[str]:
    """Those that the URDF does not have, or that the drive narrows."""
    facts = joint.facts
    ends = [f"    position_{end}_{unit}: {number(value)}" for end, value in _ends(joint)]
    if not joint.ignores:
        narrower = isfinite(joint.low) and (joint.low, joint.high) != (facts.low, facts.high)
        lines = ends if narrower else []
        if joint.velocity < facts.velocity:
            lines.append(f"    velocity_limit_{unit}_per_s: {number(joint.velocity)}")
        if joint.torque < facts.effort:
            lines.append(f"    torque_limit_{force}: {number(joint.torque)}")
        return [f"{line} # the drive's frames carry no more" for line in lines]
    return [
        "    urdf_limits: ignore # placeholders, or too weak for the weight; these count instead:",
        *(f"{line} # guess: mechanical stop, less a margin" for line in ends),
        f"    velocity_limit_{unit}_per_s: {number(joint.velocity)} # guess: datasheet",
        f"    torque_limit_{force}: {number(joint.torque)} # guess: datasheet; the weight needs "
        f"{facts.gravity:.3g}",
    ]


def _rate_lines(joint: JointGuess, force: str) -> list[str]:
    if joint.torque_rate is None:
        return []
    return [f"    torque_rate_limit_{force}_per_s: {number(joint.torque_rate)} # guess: heavy arm"]


def _ends(joint: JointGuess) -> list[tuple[str, float]]:
    ends = (("min", joint.low), ("max", joint.high))
    return [(end, value) for end, value in ends if isfinite(value)]


def _gains(guesses: Guesses) -> str:
    K_q = ", ".join(number(joint.K_q) for joint in guesses.joints)
    D_null = ", ".join(number(joint.D_null) for joint in guesses.joints)
    return f"""
# Soft: about 1 Hz at every joint. limber check SCENARIO compares gains with what is stable.
gains:
  K_q_Nm_per_rad: [{K_q}] # guess: from the URDF's inertia
  joint_damping_ratio: {number(RATIO)}
  K_x_translation_N_per_m: {number(guesses.K_x)} # guess: from the moving mass
  K_x_rotation_Nm_per_rad: {number(guesses.K_rotation)} # guess: likewise
  damping_ratio: {number(RATIO)}
  K_null_Nm_per_rad: 0
  D_null_Nms_per_rad: [{D_null}] # guess: from the URDF's inertia"""
