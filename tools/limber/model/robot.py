"""A robot folder as the tools need it; the C++ programs are the ones that check it."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from limber.errors import InputError
from limber.model.dynamics import ArmDynamics
from limber.model.names import require_name
from limber.model.urdf import Chain, Joint
from limber.output import copy_new
from limber.paths import robot_folder

EARTH = (0.0, 0.0, -9.81)  # m/s², root axes
# libyaml reads several times faster; a PyYAML built from source may lack it.
SAFE_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


@dataclass(frozen=True)
class SpringPair:
    """Two motors that pull a joint through quadratic springs: stiffness 2 k2 c at preload c."""

    k2_Nm_per_rad2: float
    preload_max_rad: float


@dataclass(frozen=True)
class JointInfo:
    """Limits and the friction that holds it at rest: rad, rad/s and N m, or m, m/s and N; infinite
    where there is none. `torque` is the tightest of URDF, motor and joint. `friction`: of motor and
    gear; `link_friction`: of the bearing behind springs and torque sensors.
    """

    name: str
    low: float
    high: float
    friction: float
    link_friction: float = 0.0
    pair: SpringPair | None = None
    velocity: float = np.inf
    torque: float = np.inf


@dataclass(frozen=True)
class Robot:
    """`K_q`, N m/rad, and `K_x`, 6x6 [linear; angular], are what a law starts with.

    `gravity` is the acceleration in base axes, m/s²; `home` in rad or m.
    """

    name: str
    folder: Path
    urdf: Path
    base: str
    tip: str
    rate_hz: float
    gravity: np.ndarray
    buses: dict[str, str]  # name -> address
    joints: list[JointInfo]
    home: np.ndarray
    K_q: np.ndarray
    K_x: np.ndarray

    @cached_property
    def chain(self) -> Chain:
        return Chain(self.urdf, self.base, self.tip)

    @cached_property
    def dynamics(self) -> ArmDynamics:
        return ArmDynamics(self.urdf, self.chain, self.gravity)

    @property
    def joint_names(self) -> list[str]:
        return [joint.name for joint in self.joints]


def read_yaml(path: Path) -> dict[str, Any]:
    try:
        with open(path, encoding="utf-8") as file:
            content = yaml.load(file, SAFE_LOADER)
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from error
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise InputError(f"{path} is not YAML: {' '.join(str(error).split())}") from error
    if not isinstance(content, dict):
        raise InputError(f"{path} is not a table of keys and values")
    return content


def load_robot(name_or_path: str, beside: Path | None = None) -> Robot:
    folder = robot_folder(name_or_path, beside)
    content = read_yaml(folder / "robot.yaml")
    try:
        return _robot(content, folder)
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(
            f"{folder / 'robot.yaml'}: {error} is missing or wrong; see `limber check {folder}`"
        ) from error


def copy_description(robot: Robot, folder: Path) -> None:
    """robot.yaml and the URDF, as they are beside a log."""
    copy_new(robot.folder / "robot.yaml", folder / "robot.yaml")
    copy_new(robot.urdf, folder / robot.urdf.name)


def _robot(content: dict[str, Any], folder: Path) -> Robot:
    urdf, gains = folder / content["urdf"], content["gains"]
    chain = Chain(urdf, content["base"], content["tip"])
    K_t, K_r = gains["K_x_translation_N_per_m"], gains["K_x_rotation_Nm_per_rad"]
    names, motors = chain.joint_names, content.get("motors") or {}
    joints = [content["joints"][name] for name in names]
    return Robot(
        name=require_name(content["name"], folder / "robot.yaml"),
        folder=folder,
        urdf=urdf,
        base=content["base"],
        tip=content["tip"],
        rate_hz=float(content["rate_hz"]),
        gravity=chain.R_RB.T @ np.asarray(content.get("gravity_m_per_s2", EARTH), float),
        buses={bus["name"]: bus["can"] for bus in content["buses"]},
        joints=[
            _joint(chain.joint(name), joint, motors.get(joint.get("motor")) or {})
            for name, joint in zip(names, joints, strict=True)
        ],
        home=np.array([_either(joint, "home_rad", "home_m", otherwise=0.0) for joint in joints]),
        K_q=np.broadcast_to(np.asarray(gains["K_q_Nm_per_rad"], float), len(names)).copy(),
        K_x=np.diag([float(K_t)] * 3 + [float(K_r)] * 3),
    )


def _joint(urdf: Joint, content: dict[str, Any], motor: dict[str, Any]) -> JointInfo:
    ignored = content.get("urdf_limits") == "ignore"
    low, high = (-np.inf, np.inf) if ignored else urdf.limits
    velocity, effort = (np.inf if ignored else urdf.most(key) for key in ("velocity", "effort"))
    peak = _either(motor, "peak_torque_Nm", "peak_torque_N", otherwise=np.inf)
    own = _either(content, "torque_limit_Nm", "torque_limit_N", otherwise=np.inf)
    return JointInfo(
        urdf.name,
        _either(content, "position_min_rad", "position_min_m", otherwise=low),
        _either(content, "position_max_rad", "position_max_m", otherwise=high),
        _at_rest(content.get("friction") or {}),
        _at_rest(content.get("link_friction") or {}),
        _pair(content.get("transmission") or {}),
        _either(content, "velocity_limit_rad_per_s", "velocity_limit_m_per_s", otherwise=velocity),
        min(own, peak, effort),
    )


def _at_rest(friction: dict[str, Any]) -> float:
    return max(
        _either(friction, "coulomb_Nm", "coulomb_N", otherwise=0.0),
        _either(friction, "static_Nm", "static_N", otherwise=0.0),
    )


def _pair(transmission: dict[str, Any]) -> SpringPair | None:
    spring = transmission.get("spring") or {}
    if transmission.get("kind") != "antagonistic" or spring.get("law") != "quadratic":
        return None
    return SpringPair(float(spring["k2_Nm_per_rad2"]), float(transmission["preload_max_rad"]))


def _either(mapping: dict[str, Any], *keys: str, otherwise: float) -> float:
    """The value of whichever key there is: rotary and prismatic joints name their units."""
    return float(next((mapping[key] for key in keys if key in mapping), otherwise))
