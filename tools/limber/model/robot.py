"""A robot as the tools need it, made from what limber-check resolves its folder to."""

import json
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from limber.arrays import Floats
from limber.model.bodies import Body, Inertial, bodies, inertials_of
from limber.model.checker import kept, resolved
from limber.model.dynamics import ArmDynamics
from limber.model.urdf import Chain, Joint, joints_of
from limber.output import copy_new, write_new
from limber.paths import robot_folder

FORMAT = "limber-resolved-robot/1"

_known: dict[Path, tuple[list[int], dict[str, Any]]] = {}


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
class HandInfo:
    """`hand:` of robot.yaml, in SI units. `width_m` over `angle_rad`: its travel table."""

    width_m: Floats
    angle_rad: Floats
    stiffness_N_per_m: float
    damping_Ns_per_m: float
    force_limit_N: float
    hold_force_N: float
    speed_limit_m_per_s: float
    continuous_torque_Nm: float


@dataclass(frozen=True)
class Robot:
    """`K_q`, N m/rad, and `K_x`, 6x6 [linear; angular], are what a law starts with.

    `gravity` is the acceleration in base axes, m/s²; `home` in rad or m. `resolved`: all that
    limber-check gives, by its keys.
    """

    name: str
    folder: Path
    urdf: Path
    base: str
    tip: str
    rate_hz: float
    gravity: Floats
    buses: dict[str, str]  # name -> address
    joints: list[JointInfo]
    home: Floats
    K_q: Floats
    K_x: Floats
    resolved: dict[str, Any] = field(repr=False, compare=False)
    hand: HandInfo | None = None

    @cached_property
    def frames(self) -> dict[str, Joint]:
        """All joints of the URDF, by child link."""
        return joints_of(self.resolved["tree"])

    @cached_property
    def inertials(self) -> dict[str, Inertial]:
        """Of the links that move."""
        return inertials_of(self.resolved["tree"])

    @cached_property
    def chain(self) -> Chain:
        return Chain(self.frames, self.base, self.tip)

    @cached_property
    def bodies(self) -> list[Body]:
        return bodies(self.chain, self.frames, self.inertials)

    @cached_property
    def dynamics(self) -> ArmDynamics:
        return ArmDynamics(self.chain, self.bodies, self.gravity)

    @property
    def joint_names(self) -> list[str]:
        return [joint.name for joint in self.joints]


def load_robot(name_or_path: str) -> Robot:
    """A shipped robot's name, or a folder. Raises InputError with limber-check's complaints."""
    return robot_of(_description(robot_folder(name_or_path)))


def load_urdf(urdf: Path, base: str, tip: str) -> Robot:
    """Without robot.yaml: no buses, and soft gains. Raises InputError."""
    return robot_of(resolved(["urdf", str(urdf), "--base", base, "--tip", tip, "--resolved"]))


def robot_beside(folder: Path) -> Robot | None:
    """Of a log: as it was resolved when the run was recorded, or the copy of robot.yaml; None
    without either. Raises InputError.
    """
    found = kept(folder / "robot.json", FORMAT)
    if found is not None:
        return placed(robot_of(found), folder)
    return load_robot(str(folder.resolve())) if (folder / "robot.yaml").is_file() else None


def placed(robot: Robot, folder: Path) -> Robot:
    """Read from its description beside a log, where copies of its files lie."""
    folder = folder.resolve()
    return replace(robot, folder=folder, urdf=folder / robot.urdf.name)


def copy_description(robot: Robot, folder: Path) -> None:
    """robot.yaml and the URDF, for a folder that programs may load."""
    copy_new(robot.folder / "robot.yaml", folder / "robot.yaml")
    copy_new(robot.urdf, folder / robot.urdf.name)


def keep_description(robot: Robot, folder: Path) -> None:
    """The same beside a log, and what they were resolved to."""
    copy_description(robot, folder)
    write_new(folder / "robot.json", json.dumps(robot.resolved))


def robot_of(found: dict[str, Any]) -> Robot:
    """From limber-check's description."""
    gains, joints = found["gains"], found["joints"]
    K_t, K_r = gains["K_x_translation_N_per_m"], gains["K_x_rotation_Nm_per_rad"]
    return Robot(
        name=found["name"],
        folder=Path(found["folder"]).resolve(),
        urdf=Path(found["urdf"]).resolve(),
        base=found["base"],
        tip=found["tip"],
        rate_hz=found["rate_hz"],
        gravity=np.array(found["gravity_m_per_s2"], float),
        buses={bus["name"]: bus["can"] for bus in found["buses"]},
        joints=[_joint(joint) for joint in joints],
        home=np.array([joint["home"] for joint in joints], float),
        K_q=np.array(gains["K_q_Nm_per_rad"], float),
        K_x=np.diag([float(K_t)] * 3 + [float(K_r)] * 3),
        resolved=found,
        hand=_hand(found.get("hand")),
    )


def _description(folder: Path) -> dict[str, Any]:
    """Resolved again only after a change of robot.yaml or the URDF."""
    stamps, found = _known.get(folder, ([], {}))
    if not found or _stamps(folder, found) != stamps:
        found = resolved(["robot", str(folder), "--resolved"])
        _known[folder] = _stamps(folder, found), found
    return found


def _stamps(folder: Path, found: dict[str, Any]) -> list[int]:
    files = (folder / "robot.yaml", Path(found["urdf"]))
    return [path.stat().st_mtime_ns if path.exists() else 0 for path in files]


def _joint(found: dict[str, Any]) -> JointInfo:
    friction, link_friction = (found.get(key, {}) for key in ("friction", "link_friction"))
    return JointInfo(
        found["name"],
        _limit(found["position_min"], -np.inf),
        _limit(found["position_max"], np.inf),
        friction.get("static_Nm", 0.0),
        link_friction.get("static_Nm", 0.0),
        _pair(found),
        _limit(found["velocity_limit"], np.inf),
        _limit(found["torque_limit_Nm"], np.inf),
    )


def _hand(found: dict[str, Any] | None) -> HandInfo | None:
    if found is None:
        return None
    given = {name: found[name] for name in HandInfo.__dataclass_fields__}
    table = {key: np.array(given[key], float) for key in ("width_m", "angle_rad")}
    return HandInfo(**{**given, **table})


def _pair(found: dict[str, Any]) -> SpringPair | None:
    if found.get("transmission") != "antagonistic" or found["spring_law"] != "quadratic":
        return None
    return SpringPair(found["spring_k2_Nm_per_rad2"], found["preload_max_rad"])


def _limit(value: float | None, otherwise: float) -> float:
    """JSON has no infinity: null."""
    return otherwise if value is None else float(value)
