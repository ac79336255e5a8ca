"""What the controller lists of its gains and laws: keys, kinds, units, ranges, words."""

import json
from functools import cache
from typing import Any

from limber.errors import RunError
from limber.paths import captured, program

MAPPED = ("salisbury", "congruence_stiffness", "mapped_joint_impedance", "variable_stiffness")
"""Laws with a goal for joints whose stiffness is K_x."""


@cache
def listing(robot: str | None = None) -> dict[str, Any]:
    """All gains and laws; with a robot also which laws it cannot run, and why."""
    command = [str(program("limber-controller")), "--list-laws", "--json"]
    if robot is not None:
        command += ["--robot", robot]
    done = captured(command)
    if done.returncode != 0:
        raise RunError(f"limber-controller does not list its laws: {done.stderr.strip()}")
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def law_names() -> list[str]:
    """In the order of their numbers in CONTROLLER_STATUS."""
    return [law["name"] for law in listing()["laws"]]


def acts_at_joints(law: str) -> bool:
    """Whether K_q is the law's stiffness, instead of K_x."""
    found = next((entry for entry in listing()["laws"] if entry["name"] == law), None)
    return found is not None and "joints" in found["goal"] and law not in MAPPED
