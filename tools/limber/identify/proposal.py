"""Writes what an identification proposes: never over the robot's own files.

In the folder of the results, for an identification called NAME:
    NAME.yaml          the changed numbers alone, as they would stand in robot.yaml
    NAME.robot.yaml    robot.yaml with them, comments kept
    NAME.robot.urdf    or the URDF with other masses and centres, where those were identified
    NAME.diff          from the one to the other, for `patch`
    NAME.png           samples and fits
"""

import difflib
from pathlib import Path
from typing import Any

import yaml

from limber.errors import InputError
from limber.identify.arm import Arm
from limber.identify.findings import Findings
from limber.identify.urdf_edit import with_inertials
from limber.identify.yaml_edit import fragment, set_number
from limber.output import write_again

DIGITS = 5


def write(found: Findings, arm: Arm, name: str, folder: Path) -> list[Path]:
    files = _urdf(found, arm, name) if found.inertials else _yaml(found, arm, name)
    for file, content in files.items():
        write_again(folder / file, content)
    return [folder / file for file in files]


def _yaml(found: Findings, arm: Arm, name: str) -> dict[str, str]:
    text = arm.yaml.read_text(encoding="utf-8")
    changes: dict[tuple[str, ...], Any] = {}
    merged = text
    for path, proposed, _ in found.proposals():
        if path in changes:
            continue
        number = f"{proposed:.{DIGITS}g}"
        changes[path] = yaml.safe_load(number)
        merged = set_number(merged, path, number)
    if not changes:
        return {}
    return {
        f"{name}.yaml": f"# Proposed by limber identify {name}\n{fragment(changes)}",
        f"{name}.robot.yaml": merged,
        f"{name}.diff": difference(text, merged, arm.yaml),
    }


def _urdf(found: Findings, arm: Arm, name: str) -> dict[str, str]:
    for link, (mass, _) in found.inertials.items():
        if not mass > 0.0:
            raise InputError(
                f"the least change makes {link} weigh {mass:.3g} kg: something other than the "
                "links' weight is in these torques (a payload, a contact, a wrong torque constant)"
            )
    urdf = arm.robot.urdf
    before, after = with_inertials(urdf, {}), with_inertials(urdf, found.inertials)
    return {f"{name}.robot.urdf": after, f"{name}.diff": difference(before, after, urdf)}


def difference(before: str, after: str, path: Path) -> str:
    lines = difflib.unified_diff(
        before.splitlines(keepends=True),
        after.splitlines(keepends=True),
        str(path),
        f"{path} (proposed)",
    )
    return "".join(lines)
