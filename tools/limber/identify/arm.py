"""Parameters of each joint as robot.yaml's text has them, which identification starts from and may
change: what stands there by default is another matter.
"""

from dataclasses import dataclass
from typing import Any

from limber.model.robot import Robot, load_robot
from limber.yaml_file import read_yaml

# Endings of keys, rotary and prismatic joints.
UNITS = {
    "_Nm": "_N",
    "_rad_per_s": "_m_per_s",
    "_rad": "_m",
    "_Nms_per_rad": "_Ns_per_m",
    "_Nm_per_rad": "_N_per_m",
    "_Nm_per_rad2": "_N_per_m2",
}


@dataclass(frozen=True)
class JointBelief:
    """At the joint, behind the gear: N m, rad, kg m² (prismatic joints: N, m, kg)."""

    name: str
    motor: str
    prismatic: bool
    motor_values: dict[str, Any]
    values: dict[str, Any]

    @property
    def gear_ratio(self) -> float:
        return float(self.motor_values["gear_ratio"])

    @property
    def torque_constant(self) -> float:
        """N m per ampere at the joint."""
        return self.gear_ratio * float(self.motor_values["rotor_torque_constant_Nm_per_A"])

    @property
    def rotor_inertia(self) -> float:
        return self.gear_ratio**2 * float(self.motor_values["rotor_inertia_kgm2"])

    @property
    def transmission(self) -> dict[str, Any]:
        return self.values.get("transmission") or {"kind": "rigid"}

    @property
    def two_motors(self) -> bool:
        return "antagonist" in self.values

    @property
    def torque_loop(self) -> bool:
        """The drive works on a sensed torque: its motor's torque is not the command."""
        return float((self.values.get("torque_loop") or {}).get("inertia_ratio", 1.0)) > 1.0

    def key(self, rotary: str) -> str:
        """A key of robot.yaml with the unit that this kind of joint has."""
        if not self.prismatic:
            return rotary
        ending = next(e for e in sorted(UNITS, key=len, reverse=True) if rotary.endswith(e))
        return rotary.removesuffix(ending) + UNITS[ending]

    def believed(self, *path: str) -> float | None:
        """The number under these keys of the joint; None if it is not there."""
        value: Any = self.values
        for key in path:
            value = value.get(key) if isinstance(value, dict) else None
        return None if value is None else float(value)


class Arm:
    """A robot with the joint parameters of its robot.yaml."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.yaml = robot.folder / "robot.yaml"
        content = read_yaml(self.yaml)
        kinds = {joint.name: joint.kind for joint in robot.chain.joints}
        self.joints = []
        for name in robot.joint_names:
            values = content["joints"][name]
            motor = values["motor"]
            self.joints.append(
                JointBelief(
                    name, motor, kinds[name] == "prismatic", content["motors"][motor], values
                )
            )


def load_arm(name_or_folder: str) -> Arm:
    return Arm(load_robot(name_or_folder))
