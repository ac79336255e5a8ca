"""A scenario as the tools need it; the C++ programs are the ones that check it."""

from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np

from limber.arrays import Floats
from limber.errors import InputError
from limber.model.names import require_name
from limber.model.robot import Robot, load_robot, read_yaml

GAINS_S = 1.0  # when the gains of `active_with` arrive
DEFAULT_LAW = "cartesian_impedance"


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
    at_s: float
    point: Floats
    normal: Floats
    stiffness_N_per_m: float


@dataclass(frozen=True)
class Tolerances:
    """Relative; from the scenario's `measure` section."""

    stiffness: float = 0.02
    contact_force: float = 0.02


@dataclass
class Scenario:
    name: str
    path: Path
    robot: Robot
    lockstep: bool = True
    duration_s: float = 10.0
    seed: int = 1
    friction: bool = True
    record: bool = True
    pushes: list[Push] = field(default_factory=list)
    gains: list[Gains] = field(default_factory=list)
    walls: list[Wall] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    event_times: list[float] = field(default_factory=list)
    tolerances: Tolerances = field(default_factory=Tolerances)
    warnings: list[str] = field(default_factory=list)  # of limber-check
    notes: list[str] = field(default_factory=list)  # limber-check's, of the robot

    def gains_at(self, time_s: float) -> Gains:
        """The requested gains at a time; `gains` starts with the robot's own."""
        return [gains for gains in self.gains if gains.at_s <= time_s][-1]


def load_scenario(path: Path, robot: Path | None = None) -> Scenario:
    """`robot`: the folder to read it from instead of the one the scenario names."""
    content = read_yaml(path)
    try:
        loaded = load_robot(str(robot or content["robot"]), beside=path.resolve().parent)
        scenario = Scenario(
            name=require_name(content["name"], path) if "name" in content else path.stem,
            path=path.resolve(),
            robot=loaded,
            lockstep=content.get("mode", "lockstep") == "lockstep",
            duration_s=float(content["duration_s"]),
            seed=int(content.get("seed", 1)),
            friction=bool(content.get("friction", True)),
            record=bool(content.get("record", True)),
            gains=[Gains(0.0, DEFAULT_LAW, loaded.K_x, loaded.K_q)],
            tolerances=_tolerances(content.get("measure"), path),
        )
        for entry in sorted(content.get("timeline") or [], key=lambda entry: float(entry["at_s"])):
            _add(scenario, entry)
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(
            f"{path}: {error} is missing or wrong; see `limber check {path}`"
        ) from error
    return scenario


def active_with(gains: dict[str, Any]) -> list[dict[str, Any]]:
    """How most timelines begin: the arm is held, becomes active, and gets its gains."""
    return [
        {"at_s": 0.3, "mode": "hold"},
        {"at_s": 0.8, "mode": "active"},
        {"at_s": GAINS_S, "gains": gains},
    ]


def _tolerances(content: Any, path: Path) -> Tolerances:
    """The mapping `measure`: {stiffness: 0.02, contact_force: 0.02}; a list is for the
    experiments.
    """
    if not isinstance(content, dict):
        return Tolerances()
    known = [item.name for item in fields(Tolerances)]
    for key, value in content.items():
        if key not in known:
            raise InputError(
                f"{path}: measure: unknown key '{key}'; allowed here: {', '.join(known)}"
            )
        if isinstance(value, bool) or not isinstance(value, int | float) or not 0 < value <= 1:
            raise InputError(
                f"{path}: measure: {key}: '{value}' is wrong; expected a number in (0, 1]"
            )
    return Tolerances(**content)


def _add(scenario: Scenario, entry: dict[str, Any]) -> None:
    at_s = float(entry["at_s"])
    kind = next(key for key in entry if key != "at_s")
    content = entry[kind]
    scenario.event_times.append(at_s)
    if kind == "push":
        scenario.pushes.append(_push(at_s, content))
    elif kind == "gains":
        law = scenario.gains[-1].law  # a reset keeps it
        before = scenario.gains[0 if content.get("reset") else -1]
        scenario.gains.append(_changed(before, at_s, {"law": law, **content}))
    elif kind == "wall" and isinstance(content, dict):
        normal = np.asarray(content["normal"], float)
        stiffness = float(content["stiffness_N_per_m"])
        point = np.asarray(content["point_m"], float)
        scenario.walls.append(Wall(at_s, point, normal / np.linalg.norm(normal), stiffness))
    elif kind == "fault":
        scenario.faults.append(str(content["kind"]))


def _push(at_s: float, content: dict[str, Any]) -> Push:
    wrench = np.zeros(6)
    wrench[:3] = content.get("force_N", 0.0)
    wrench[3:] = content.get("torque_Nm", 0.0)
    ramp_s, duration_s = float(content.get("ramp_s", 0.0)), float(content["for_s"])
    return Push(at_s, wrench, ramp_s, duration_s, str(content.get("link", "")))


def _changed(before: Gains, at_s: float, content: dict[str, Any]) -> Gains:
    """What is not named stays as it was. Naming one half's diagonal clears the coupling with the
    other.
    """
    K_x, K_q = before.K_x.copy(), before.K_q.copy()
    if "K_x" in content:
        K_x = np.asarray(content["K_x"], float)
    blocks = {"K_x_translation_N_per_m": slice(0, 3), "K_x_rotation_Nm_per_rad": slice(3, 6)}
    for key, rows in blocks.items():
        if key in content:
            K_x[rows, :] = K_x[:, rows] = 0.0
            K_x[rows, rows] = np.diag(np.broadcast_to(np.asarray(content[key], float), 3))
    if "K_q_Nm_per_rad" in content:
        K_q[:] = content["K_q_Nm_per_rad"]
    return Gains(
        at_s,
        str(content.get("law", before.law)),
        K_x,
        K_q,
        str(content.get("friction_compensation", before.friction_compensation)),
        float(content.get("friction_share", before.friction_share)),
        str(content.get("frame", before.frame)),
    )
