"""What robot.yaml and its URDF say of each motor: where it is on the bus, and its limits.

Read here once more, on purpose: the referee takes nothing from the programs that it judges.
"""

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from limber.errors import InputError
from limber.paths import robot_folder
from limber.yaml_file import read_yaml
from limber_qa.check_trace.urdf import Limits, joint_limits

TURN_rad = 2.0 * math.pi
PERMILLE_MOST = 32.767  # of the rated torque, in 16 bits


@dataclass(frozen=True)
class Motor:
    """One drive. Units are rad, rad/s and N m at the joint; m, m/s, N of a prismatic one.

    `position_*` and `velocity` limit the joint; of a joint with two motors they are None, unless a
    link encoder tells the joint's angle.
    """

    name: str
    protocol: str
    interface: str
    fd: bool
    number: int  # `id` of robot.yaml
    reply_id: int | None
    sign: float
    offset: float
    torque_Nm: float
    torque_step_Nm: float  # a cycle
    velocity: float | None
    position: tuple[float, float] | None
    kp: float  # what the driver holds with
    kd: float
    keys: dict[str, Any] = field(repr=False)  # of the motor's type
    counts_per_turn: float = 1.0
    link_counts_per_turn: float | None = None
    torque_sensor: bool = False

    def within_travel(self, angle: float) -> float:
        """Of a drive that knows a single turn: the angle, or that a whole turn from it, which is in
        the joint's travel.
        """
        if self.position is None or self.keys.get("keeps_turns"):
            return angle
        low, high = self.position
        turned = (angle, angle + math.tau, angle - math.tau)
        fitting = [one for one in turned if low <= one <= high]
        return fitting[0] if len(fitting) == 1 else angle


@dataclass(frozen=True)
class Arm:
    name: str
    period_ns: int
    motors: list[Motor]


def read_arm(name_or_path: str, addresses: dict[str, str] | None = None) -> Arm:
    """`addresses`: of buses by their names, instead of robot.yaml's, such as socketcan:can0.

    Raises InputError; `limber check` explains a robot.yaml that is wrong.
    """
    file = robot_folder(name_or_path) / "robot.yaml"
    content = read_yaml(file)
    try:
        buses = _buses(content, addresses or {}, file)
        limits = joint_limits(file.parent / content["urdf"], content["base"], content["tip"])
        motors = [
            motor for name, urdf in limits.items() for motor in _motors(name, urdf, content, buses)
        ]
        if "hand" in content:
            motors.append(_hand(content, buses))
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"{file}: {error} is missing or wrong; see `limber check`") from error
    return Arm(content["name"], round(1e9 / content["rate_hz"]), motors)


def _buses(content: dict[str, Any], addresses: dict[str, str], file: Path) -> dict[str, Any]:
    buses = {bus["name"]: dict(bus) for bus in content["buses"]}
    for name, address in addresses.items():
        if name not in buses:
            raise InputError(f"{file}: no bus '{name}'; its buses are {', '.join(buses)}")
        buses[name]["can"] = address
    return buses


def _motors(name: str, urdf: Limits, content: dict[str, Any], buses: dict[str, Any]) -> list[Motor]:
    joint = content["joints"][name]
    if joint.get("urdf_limits") == "ignore":
        urdf = Limits()
    first = _motor(name, joint, joint, urdf, content, buses)
    if "antagonist" not in joint:
        return [first]
    other = {"motor": joint["motor"], "bus": joint["bus"], **joint["antagonist"]}
    return [first, _motor(f"{name} (antagonist)", other, joint, urdf, content, buses)]


def _hand(content: dict[str, Any], buses: dict[str, Any]) -> Motor:
    """A joint whose way and torque are those of the travel table."""
    hand = content["hand"]
    widths, angles = hand["travel"]["width_m"], hand["travel"]["angle_rad"]
    steepest = max(
        abs((widths[i + 1] - widths[i]) / (angles[i + 1] - angles[i]))
        for i in range(len(widths) - 1)
    )
    margin = 0.1 * (max(angles) - min(angles))
    way = Limits(
        min(angles) - margin, max(angles) + margin, math.inf, hand["force_limit_N"] * steepest
    )
    return _motor("hand", hand, hand, way, content, buses)


def _motor(
    name: str,
    place: dict[str, Any],
    joint: dict[str, Any],
    urdf: Limits,
    content: dict[str, Any],
    buses: dict[str, Any],
) -> Motor:
    kind = content["motors"][place["motor"]]
    bus = buses[place["bus"]]
    two = "antagonist" in joint
    link = joint.get("link_encoder") if joint is place else None
    mit = kind.get("mit_range", {})
    field_Nm = mit.get("torque_Nm", PERMILLE_MOST * kind.get("rated_torque_Nm", math.inf))
    own_Nm = min(kind["peak_torque_Nm"], field_Nm)
    joint_Nm = min(urdf.effort, own_Nm, _of(joint, "torque_limit", math.inf))
    rate = _of(joint, "torque_rate_limit", min(joint_Nm / 0.02, 1000.0))
    step_Nm = rate / content["rate_hz"]
    hold = joint.get("hold", {})
    judged = link is not None or not two
    velocity = min(urdf.velocity, mit.get("velocity_rad_per_s", math.inf))
    return Motor(
        name=name,
        protocol=kind["protocol"],
        interface=bus["can"].partition(":")[2],
        fd=bool(bus.get("fd", False)),
        number=int(place["id"]),
        reply_id=place.get("reply_id"),
        sign=float(place.get("sign", 1)),
        offset=_of(place, "offset", 0.0),
        torque_Nm=own_Nm if two else joint_Nm,
        # Torque may step by one limit and preload by two; a motor makes half of each.
        torque_step_Nm=1.5 * step_Nm if two else step_Nm,
        velocity=min(velocity, _of(joint, "velocity_limit", math.inf)) if judged else None,
        position=_position(joint, urdf) if judged else None,
        kp=_of(hold, "kp", 0.0),
        kd=_of(hold, "kd", 0.0),
        keys=kind,
        counts_per_turn=_counts(kind),
        link_counts_per_turn=2.0 ** link["bits"] if link else None,
        torque_sensor=bool(joint.get("torque_sensor")) and joint is place,
    )


def _position(joint: dict[str, Any], urdf: Limits) -> tuple[float, float]:
    return _of(joint, "position_min", urdf.low), _of(joint, "position_max", urdf.high)


def _counts(kind: dict[str, Any]) -> float:
    return float(kind.get("counts_per_turn") or 2.0 ** kind.get("encoder_bits", 0))


def _of(mapping: dict[str, Any], word: str, otherwise: float) -> float:
    """The value of the key that begins with `word` and goes on with a unit."""
    for key, value in mapping.items():
        rest = key.removeprefix(word + "_")
        if rest != key and rest.split("_")[0] in ("rad", "m", "Nm", "N", "Nms", "Ns"):
            return float(value)
    return otherwise
