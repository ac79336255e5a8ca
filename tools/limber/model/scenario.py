"""A scenario as the tools need it, made from what limber-check resolves its file to."""

import json
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from limber.arrays import Floats
from limber.model.checker import kept, resolved
from limber.model.robot import Robot, keep_description, placed, robot_of
from limber.output import copy_new, write_new
from limber.paths import scenario_file

GAINS_S = 1.0  # when the gains of `active_with` arrive
FORMAT = "limber-resolved-scenario/1"


@dataclass(frozen=True)
class Push:
    """A hand on the arm: `wrench` in base axes, N and N m; both edges take `ramp_s` of
    `duration_s`.
    """

    at_s: float
    wrench: Floats
    ramp_s: float
    duration_s: float
    link: str = ""  # empty: the tip


@dataclass(frozen=True)
class Gains:
    """What holds from `at_s` on. `frame`: "base" or "goal", whose axes K_x is in.
    `friction_compensation`: a word of `gains:`.
    """

    at_s: float
    law: str
    K_x: Floats
    K_q: Floats
    friction_compensation: str = "none"
    friction_share: float = 0.0
    frame: str = "base"

    def in_base(self, R_BD: Floats) -> Floats:
        """K_x in base axes, with the goal's orientation."""
        if self.frame == "base":
            return self.K_x
        R = np.kron(np.eye(2), R_BD)
        return R @ self.K_x @ R.T

    @property
    def friction_observed(self) -> bool:
        """Torque sensors see the gears' friction, and all of it is made up for."""
        return self.friction_compensation == "observer" and self.friction_share == 1.0

    @property
    def dithered(self) -> bool:
        """The motors swing a little, so that the gears do not stick."""
        return self.friction_compensation == "dither"


@dataclass(frozen=True)
class Wall:
    """A point, m, and the unit normal towards free space, base axes."""

    at_s: float
    point: Floats
    normal: Floats
    stiffness_N_per_m: float


@dataclass(frozen=True)
class Tolerances:
    """Relative; from the scenario's `measure` section."""

    stiffness: float
    contact_force: float


@dataclass
class Scenario:
    """`gains` starts with the robot's own. `timeline`: limber-check's entries, in order of time.
    `resolved`: all that limber-check gives, by its keys.
    """

    name: str
    path: Path
    robot: Robot
    lockstep: bool
    duration_s: float
    seed: int
    friction: bool
    friction_factor: float  # times robot.yaml's, in the simulated arm
    record: bool
    law_files: list[str]  # laws of one's own
    pushes: list[Push]
    gains: list[Gains]
    walls: list[Wall]
    faults: list[str]
    timeline: list[dict[str, Any]]
    tolerances: Tolerances
    warnings: list[str]
    notes: list[str]  # the robot's, too
    resolved: dict[str, Any] = field(repr=False)

    def gains_at(self, time_s: float) -> Gains:
        """The requested gains at a time."""
        return [gains for gains in self.gains if gains.at_s <= time_s][-1]

    @property
    def event_times(self) -> list[float]:
        return [entry["at_s"] for entry in self.timeline]


def load_scenario(path: Path, robot: Path | None = None) -> Scenario:
    """`robot`: the folder to read it from instead of the one the scenario names. Raises InputError
    with limber-check's complaints.
    """
    path = scenario_file(path)
    other = [] if robot is None else ["--robot", str(robot)]
    return _scenario(resolved(["scenario", str(path), "--json", *other]), path.resolve())


def scenario_beside(folder: Path) -> Scenario | None:
    """Of a log: as it was resolved when the run was recorded, or its copy with that of the robot;
    None without either. Raises InputError.
    """
    found = kept(folder / "scenario.json", FORMAT)
    path = folder.resolve() / "scenario.yaml"
    if found is None:
        return load_scenario(path, robot=path.parent) if path.is_file() else None
    scenario = _scenario(found, path)
    return replace(scenario, robot=placed(scenario.robot, folder))


def keep_scenario(scenario: Scenario, folder: Path) -> None:
    """Scenario and robot as they were, beside a log, and what they were resolved to."""
    copy_new(scenario.path, folder / "scenario.yaml")
    write_new(folder / "scenario.json", json.dumps(scenario.resolved))
    keep_description(scenario.robot, folder)


def active_with(gains: dict[str, Any]) -> list[dict[str, Any]]:
    """How most timelines begin: the arm is held, becomes active, and gets its gains."""
    return [
        {"at_s": 0.3, "mode": "hold"},
        {"at_s": 0.8, "mode": "active"},
        {"at_s": GAINS_S, "gains": gains},
    ]


def _scenario(found: dict[str, Any], path: Path) -> Scenario:
    timeline = found["timeline"]
    return Scenario(
        name=found["name"],
        path=path,
        robot=robot_of(found["robot"]),
        lockstep=found["mode"] == "lockstep",
        duration_s=found["duration_s"],
        seed=found["seed"],
        friction=found["friction"],
        friction_factor=found.get("friction_factor", 1.0),  # younger than some logs
        record=found["record"],
        law_files=found["law_files"],
        pushes=[_push(entry["at_s"], entry["push"]) for entry in timeline if "push" in entry],
        gains=[_gains(entry) for entry in found["gains"]],
        walls=[_wall(entry["at_s"], entry["wall"]) for entry in timeline if entry.get("wall")],
        faults=[entry["fault"] for entry in timeline if "fault" in entry],
        timeline=timeline,
        tolerances=Tolerances(**found["measure"]),
        warnings=[*found["warnings"], *found["refused"]],
        notes=found["notes"],
        resolved=found,
    )


def _push(at_s: float, entry: dict[str, Any]) -> Push:
    wrench = np.array(entry["wrench_N_Nm"], float)
    return Push(at_s, wrench, entry["ramp_s"], entry["for_s"], entry["link"])


def _wall(at_s: float, entry: dict[str, Any]) -> Wall:
    point, normal = (np.array(entry[key], float) for key in ("point_m", "normal"))
    return Wall(at_s, point, normal, entry["stiffness_N_per_m"])


def _gains(entry: dict[str, Any]) -> Gains:
    K_x, K_q = (np.array(entry[key], float) for key in ("K_x", "K_q_Nm_per_rad"))
    words = (entry[key] for key in ("friction_compensation", "friction_share", "frame"))
    return Gains(entry["at_s"], entry["law"], K_x, K_q, *words)
