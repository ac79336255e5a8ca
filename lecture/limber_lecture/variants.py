"""A shipped robot with something changed: a sensor, friction, another rate."""

import shutil
from pathlib import Path
from typing import Any

import yaml

from limber.paths import output_folder, robot_folder
from limber.yaml_file import read_yaml
from limber_lecture.evaluate import plain

# Reads forces without noise, rounding or delay of its own; nothing hangs behind it
TIP_SENSOR = {
    "model": "ideal",
    "protocol": "limber_ft",
    "id": 100,
    "reply_id": 101,
    "pose": {"position_m": [0.0, 0.0, 0.0], "rpy_rad": [0.0, 0.0, 0.0]},
    "range": {"force_N": 500.0, "torque_Nm": 100.0},
}


def friction(coulomb: float = 0.0, viscous: float = 0.0) -> dict[str, float]:
    """Of a motor or a link: N m, N m s/rad."""
    return {"coulomb_Nm": coulomb, "viscous_Nms_per_rad": viscous}


def variant(out: Path, robot: str, changes: dict[str, Any]) -> str:
    """Writes the robot to the folder OUT/robot and returns it as a scenario's `robot`.

    Mappings in `changes` are merged with robot.yaml's, None takes a key away, everything else
    replaces what is there.
    """
    source = robot_folder(robot)
    folder = output_folder(out / "robot")
    content = _merged(read_yaml(source / "robot.yaml"), changes)
    shutil.copyfile(source / content["urdf"], folder / content["urdf"])
    text = yaml.safe_dump(plain(content), sort_keys=False)
    (folder / "robot.yaml").write_text(text, encoding="utf-8")
    return str(folder.resolve())


def _merged(old: Any, new: Any) -> Any:
    if not (isinstance(old, dict) and isinstance(new, dict)):
        return new
    content = {**old, **{key: _merged(old.get(key), value) for key, value in new.items()}}
    return {key: value for key, value in content.items() if value is not None}
