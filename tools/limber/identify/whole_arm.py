"""All of an arm from one tour: weights, then friction, torque constants and springs with them.

What is proposed is written as a whole robot folder. From a scenario the tour is run in the lab
first, and once more with the proposal, while the simulated arm stays what it was: so the sag before
and after is measured. From logs of a real arm, the sag after is what the weights let expect.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from limber.errors import InputError
from limber.identify import friction, gravity, stiffness, torque_constant
from limber.identify.arm import Arm, load_arm
from limber.identify.findings import Findings, Value
from limber.identify.motion import Motion
from limber.identify.proposal import DIGITS
from limber.identify.static_poses import StaticPoses, static_poses
from limber.identify.urdf_edit import with_inertials
from limber.identify.yaml_edit import set_number
from limber.model.robot import copy_description
from limber.output import copy_new, write_again
from limber.paths import captured, program
from limber.yaml_file import read_yaml


@dataclass(frozen=True)
class Proposal:
    """`folder`: the robot as it is proposed; `changed`: keys of robot.yaml whose
    numbers differ -> the number, and what was found.
    """

    folder: Path
    found: list[Findings]
    changed: dict[tuple[str, ...], tuple[float, Value]]


def propose(arm: Arm, motion: Motion, weights_known: float | None, folder: Path) -> Proposal:
    """Writes the proposed robot to `folder`; friction and constants rest on its weights."""
    weights = gravity.identify(arm, motion)
    folder.mkdir(parents=True)
    copy_description(arm.robot, folder)
    if weights.inertials:
        text = with_inertials(arm.robot.urdf, weights.inertials)
        write_again(folder / arm.robot.urdf.name, text)
    changed_arm = load_arm(str(folder.resolve()))
    found = [
        weights,
        torque_constant.identify(changed_arm, motion, weights_known),
        friction.identify(changed_arm, motion, weights_known),
        stiffness.identify(changed_arm, motion),
    ]
    changed: dict[tuple[str, ...], tuple[float, Value]] = {}
    text = (folder / "robot.yaml").read_text(encoding="utf-8")
    for path, number, value in (change for findings in found for change in findings.proposals()):
        if path not in changed:
            changed[path] = number, value
            text = set_number(text, path, f"{number:.{DIGITS}g}")
    write_again(folder / "robot.yaml", text)
    return Proposal(folder, found, changed)


def expected_sag(arm: Arm, poses: StaticPoses) -> float:
    """rms over poses at rest of how far the tip is off because the model's weights are, with the
    joint stiffness of robot.yaml, m: |J_v K_q^-1 (tau - g)|.
    """
    off = [
        arm.robot.chain.jacobian(q)[:3] @ (tau / arm.robot.K_q)
        for q, tau in zip(poses.q, poses.tau, strict=True)
    ]
    return float(np.sqrt(np.mean(np.sum(np.square(off), axis=1))))


def measured_sag(poses: StaticPoses) -> float:
    """rms over poses at rest of the tip's distance from its goal, m."""
    return float(np.sqrt(np.mean(poses.off_m**2)))


def sags(arm: Arm, proposal: Proposal, logs: list[Path], again: Path | None) -> str:
    try:
        return _sags(arm, proposal, logs, again)
    except InputError as reason:
        return f"No sag is told: {reason}"


def _sags(arm: Arm, proposal: Proposal, logs: list[Path], again: Path | None) -> str:
    before = static_poses(logs, arm.robot.dynamics)
    if again is not None:
        after = static_poses([again], arm.robot.dynamics)
        return (
            f"Sag of the tip at rest, measured, rms: {1e3 * measured_sag(before):.3g} mm before, "
            f"{1e3 * measured_sag(after):.3g} mm with the proposal."
        )
    changed = load_arm(str(proposal.folder.resolve()))
    later = static_poses(logs, changed.robot.dynamics)
    return (
        f"Sag of the tip at rest, rms: {1e3 * measured_sag(before):.3g} mm measured. By weights "
        f"and the stiffness of robot.yaml {1e3 * expected_sag(arm, before):.3g} mm, with those "
        f"proposed {1e3 * expected_sag(changed, later):.3g} mm; run the tour again to see."
    )


def record(scenario: Path, log: Path) -> Path:
    """The log of the scenario in the lab."""
    command = [str(program("limber-lab")), str(scenario), "--log", str(log)]
    done = captured(command)
    if done.returncode != 0:
        lines = [line for line in (done.stderr + done.stdout).splitlines() if line.strip()]
        raise InputError(f"the lab could not run {scenario}: {lines[-1] if lines else 'no reason'}")
    return log


def scenario_with(scenario: Path, arm: Arm, proposal: Proposal, path: Path) -> Path:
    """The scenario for the proposed robot; the simulated arm is the one it was."""
    content = read_yaml(scenario)
    overrides = content.get("plant_overrides") or content.pop("reality", {})
    beside = arm.robot.folder / overrides.get("urdf", arm.robot.urdf.name)
    copy_new(beside, proposal.folder / "as_it_was.urdf")
    truth: dict[str, Any] = {}
    for keys, (number, value) in proposal.changed.items():
        _put(truth, keys, _as_it_was(arm, keys, number, value))
    _merge(truth, overrides)
    content |= {
        "robot": str(proposal.folder.resolve()),
        "plant_overrides": truth | {"urdf": "as_it_was.urdf"},
    }
    write_again(path, yaml.safe_dump(content, sort_keys=False))
    return path


def _as_it_was(arm: Arm, path: tuple[str, ...], proposed: float, value: Value) -> float:
    """Breakaway that robot.yaml did not name was Coulomb's."""
    if value.believed is not None:
        return value.believed
    joint = next(joint for joint in arm.joints if joint.name == value.joint)
    if path[-1] == joint.key(friction.STATIC_KEY):
        return joint.believed(path[-2], joint.key(friction.COULOMB_KEY)) or 0.0
    return proposed if path[-1] == joint.key(friction.STRIBECK_KEY) else 0.0


def _put(tree: dict[str, Any], path: tuple[str, ...], value: float) -> None:
    for key in path[:-1]:
        tree = tree.setdefault(key, {})
    tree[path[-1]] = value


def _merge(tree: dict[str, Any], over: dict[str, Any]) -> None:
    for key, value in over.items():
        if isinstance(value, dict) and isinstance(tree.get(key), dict):
            _merge(tree[key], value)
        else:
            tree[key] = value
