"""Writes what an identification proposes: never over the robot's own files.

In the folder of the results, for an identification called NAME:
    NAME.yaml          the changed numbers alone, as they would stand in robot.yaml
    NAME.robot.yaml    robot.yaml with them, comments kept
    NAME.diff          from the one to the other, for `patch`
    NAME.png           samples and fits
"""

import difflib
from pathlib import Path

import yaml

from limber.identify.arm import Arm
from limber.identify.findings import Findings
from limber.identify.yaml_edit import fragment, set_number

DIGITS = 5


def write(found: Findings, arm: Arm, name: str, folder: Path) -> list[Path]:
    text = arm.yaml.read_text(encoding="utf-8")
    changes, merged = {}, text
    for value in found.values:
        if value.path is None or value.proposed is None or value.path in changes:
            continue
        number = f"{value.proposed:.{DIGITS}g}"
        changes[value.path] = yaml.safe_load(number)
        merged = set_number(merged, value.path, number)
    if not changes:
        return []
    files = {
        folder / f"{name}.yaml": f"# Proposed by limber identify {name}\n{fragment(changes)}",
        folder / f"{name}.robot.yaml": merged,
        folder / f"{name}.diff": difference(text, merged, arm.yaml),
    }
    for path, content in files.items():
        path.write_text(content, encoding="utf-8")
    return list(files)


def difference(before: str, after: str, path: Path) -> str:
    lines = difflib.unified_diff(
        before.splitlines(keepends=True),
        after.splitlines(keepends=True),
        str(path),
        f"{path} (proposed)",
    )
    return "".join(lines)
