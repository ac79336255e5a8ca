"""The same arm with little torque: what carries it in any pose, and some for its motion."""

from pathlib import Path

import numpy as np
import yaml

from limber.arrays import Floats
from limber.model.robot import Robot
from limber.output import copy_new, write_new
from limber.paths import output_folder

POSES = 500
WEIGHTS = 1.25  # times the greatest weight that a joint carries: masses are not known better
SPARE = 0.2  # of its torque limit, to move it


def spare_torque(robot: Robot) -> Floats:
    """Of each joint beyond its weight, N m (N)."""
    return SPARE * np.array([joint.torque for joint in robot.joints])


def torque_bounds(robot: Robot) -> Floats:
    """Of each joint, N m (N)."""
    low = np.array([max(joint.low, -np.pi) for joint in robot.joints])
    high = np.array([min(joint.high, np.pi) for joint in robot.joints])
    q = np.random.default_rng(1).uniform(low, high, (POSES, len(low)))
    limits = np.array([joint.torque for joint in robot.joints])
    carried = np.abs(robot.dynamics.gravity_torque(q)).max(axis=0)
    bounds: Floats = np.minimum(limits, WEIGHTS * carried + spare_torque(robot))
    return bounds


def write_bounded(robot: Robot, folder: Path) -> Path:
    """A copy of the description with those torque limits; its folder."""
    place = output_folder(folder / robot.folder.name)
    content = yaml.safe_load((robot.folder / "robot.yaml").read_text(encoding="utf-8"))
    for joint, bound in zip(robot.resolved["joints"], torque_bounds(robot), strict=True):
        key = "torque_limit_N" if joint["type"] == "prismatic" else "torque_limit_Nm"
        content["joints"][joint["name"]][key] = round(float(bound), 3)
    write_new(place / "robot.yaml", yaml.safe_dump(content, sort_keys=False))
    copy_new(robot.urdf, place / robot.urdf.name)
    return place
