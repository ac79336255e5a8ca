"""What the controller lists of its gains and laws: keys, kinds, units, ranges, words."""

import json
import subprocess
from functools import cache
from typing import Any

from limber.errors import RunError
from limber.paths import program


@cache
def listing(robot: str | None = None) -> dict[str, Any]:
    """All gains and laws; with a robot also which laws it cannot run, and why."""
    command = [str(program("limber-controller")), "--list-laws", "--json"]
    if robot is not None:
        command += ["--robot", robot]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RunError(f"limber-controller does not list its laws: {done.stderr.strip()}")
    return json.loads(done.stdout)


def law_names() -> list[str]:
    """In the order of their numbers in CONTROLLER_STATUS."""
    return [law["name"] for law in listing()["laws"]]
