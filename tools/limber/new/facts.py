"""What a URDF and its check tell of an arm, before anybody has described its drives."""

import json
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from limber.errors import InputError
from limber.model.checker import checker_arguments, run_checker
from limber.model.robot import JointInfo, load_urdf

WALL, WALL_SHARE = 0.1, 0.1  # width of the soft wall, rad or m, and share of the travel at most
ROOM_rad, ROOM_m = 0.1, 0.03  # before it, to give way in


@dataclass(frozen=True)
class JointFacts:
    """Limits of the URDF, infinite where it has none. Units: rad, N m; m, N of a prismatic one.

    `gravity`: most torque that the weight needs, at home and anywhere; `inertia` at home.
    """

    name: str
    kind: str
    low: float
    high: float
    velocity: float
    effort: float
    gravity_home: float
    gravity: float
    inertia: float

    @property
    def slides(self) -> bool:
        return self.kind == "prismatic"


@dataclass(frozen=True)
class ArmFacts:
    urdf: Path
    base: str
    tip: str
    mass_kg: float  # of all that moves
    home: np.ndarray
    jacobian: np.ndarray  # 6xn at home
    joints: list[JointFacts]


def read(urdf: Path, base: str | None, tip: str | None) -> ArmFacts:
    """Raises InputError with limber-check's complaints, or the arms to choose from, if several."""
    done = run_checker([*checker_arguments(str(urdf), base, tip), "--json"])
    if done.returncode != 0:
        if not json.loads(done.stdout or "{}").get("chains"):
            raise InputError(done.stderr.strip())
        listed = run_checker(checker_arguments(str(urdf), base, tip))
        raise InputError(f"{listed.stderr.strip()}\n{listed.stdout.rstrip()}")
    found = json.loads(done.stdout)
    robot = load_urdf(urdf, found["base"], found["tip"])
    joints = list(zip(robot.joints, found["joints"], strict=True))
    home = np.array([_home(limits, joint["type"]) for limits, joint in joints])
    weight = np.abs(robot.dynamics.gravity_torque(home[None])[0])
    facts = zip(joints, weight, np.diag(robot.dynamics.inertia(home)), strict=True)
    return ArmFacts(
        urdf,
        robot.base,
        robot.tip,
        found["moving_mass_kg"],
        home,
        robot.chain.jacobian(home),
        [_joint(*joint, gravity, inertia) for joint, gravity, inertia in facts],
    )


def _joint(limits: JointInfo, found: dict[str, Any], gravity: float, inertia: float) -> JointFacts:
    return JointFacts(
        limits.name,
        found["type"],
        limits.low,
        limits.high,
        limits.velocity,
        limits.torque,
        gravity,
        max(gravity, found["worst_gravity_Nm"]),
        inertia,
    )


def wall(low: float, high: float) -> float:
    """How far from its ends the controller begins to hold a joint back that stands still."""
    return min(WALL, WALL_SHARE * (high - low)) if isfinite(high - low) else 0.0


def _home(limits: JointInfo, kind: str) -> float:
    """Zero, or as near to it as leaves a tenth of the travel, and room to give way before the soft
    wall, to either end; the middle of a travel that is too short for that.
    """
    low, high = limits.low, limits.high
    if not isfinite(high - low):
        return 0.0
    room = ROOM_m if kind == "prismatic" else ROOM_rad
    margin = min(max(0.1 * (high - low), wall(low, high) + room), 0.5 * (high - low))
    return round(float(np.clip(0.0, low + margin, high - margin)), 3)
