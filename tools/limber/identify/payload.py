"""Mass and centre of mass of what the tip carries, from torques at rest.

A payload of mass m with its centre at c (tip axes) adds to the weight of the arm the joint torque

    tau = -J^T [m a; (R m c) x a],     a: gravitational acceleration, base axes,

which is linear in m and m c: least squares over static poses (An, Atkeson, Hollerbach,
"Estimation of inertial parameters of rigid body links", 1985). Constant torque offsets of the
joints can be estimated along with them. Friction at rest is not modelled: it is in the standard
deviations.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from limber.errors import InputError
from limber.identify.arm import Arm
from limber.identify.commands import arm_of, folder_of
from limber.identify.findings import Panel
from limber.identify.static_poses import StaticPoses, static_poses
from limber.model.urdf import Chain
from limber.paths import output_folder

LENGTH_M = 0.1  # makes m c comparable with m
WORST_CONDITION = 200.0
LEAST_POSES = 3


@dataclass(frozen=True)
class Payload:
    """Values and standard deviations; `offsets` N m, empty if not estimated."""

    mass_kg: float
    mass_std: float
    com_m: np.ndarray
    com_std: np.ndarray
    offsets: np.ndarray
    offsets_std: np.ndarray
    condition: float
    residual_rms: float
    poses: int


def regressor(chain: Chain, q: np.ndarray, gravity: np.ndarray) -> np.ndarray:
    """n x 4: holding torque per [m, m c]."""
    R = chain.forward(q)[:3, :3]
    wrench = np.zeros((6, 4))
    wrench[:3, 0] = gravity
    for i in range(3):
        wrench[3:, 1 + i] = np.cross(R[:, i], gravity)
    return -chain.jacobian(q).T @ wrench


def identify(
    chain: Chain, q: np.ndarray, tau: np.ndarray, gravity: np.ndarray, offsets: bool = False
) -> Payload:
    """`q`, `tau`: one row a static pose; `tau` without what the arm itself weighs, N m."""
    poses, n = q.shape
    least = LEAST_POSES + offsets
    if poses < least:
        raise InputError(f"{poses} static poses; at least {least} different ones are needed")
    scale = np.array([1.0] + [1.0 / LENGTH_M] * 3 + [1.0] * (n * offsets))
    rows = []
    for pose in q:
        Y = regressor(chain, pose, gravity)
        rows.append(np.hstack([Y, np.eye(n)]) if offsets else Y)
    A, b = np.vstack(rows) * scale, tau.reshape(-1)
    condition = float(np.linalg.cond(A))
    if not condition <= WORST_CONDITION:
        raise InputError(
            f"the poses are too similar: condition number {condition:.3g}, at most "
            f"{WORST_CONDITION:g} is allowed; turn the tip about more than one horizontal axis"
        )
    x = np.linalg.lstsq(A, b, rcond=None)[0]
    residual = b - A @ x
    variance = residual @ residual / max(len(b) - len(x), 1)
    covariance = variance * np.linalg.inv(A.T @ A) * np.outer(scale, scale)
    return _payload(x * scale, covariance, condition, residual, poses)


def _payload(
    x: np.ndarray, covariance: np.ndarray, condition: float, residual: np.ndarray, poses: int
) -> Payload:
    mass, std = x[0], np.sqrt(np.diag(covariance))
    if not abs(mass) > 2.0 * std[0]:
        raise InputError(
            f"no payload is detectable: mass {mass:.4f} kg, standard deviation {std[0]:.4f} kg"
        )
    com = x[1:4] / mass
    slope = np.hstack([-com[:, None], np.eye(3)]) / mass  # of c by [m, m c]
    com_std = np.sqrt(np.diag(slope @ covariance[:4, :4] @ slope.T))
    rms = float(np.sqrt(np.mean(residual**2)))
    return Payload(mass, std[0], com, com_std, x[4:], std[4:], condition, rms, poses)


def run(
    runs: list[Path], robot: str | None, offsets: bool, out: Path | None, console: Console
) -> None:
    arm = arm_of(runs, robot)
    found = static_poses(runs, arm.robot.dynamics)
    payload = identify(arm.robot.chain, found.q, found.tau, arm.robot.gravity, offsets)
    _say(payload, arm, console)
    from limber.identify import picture  # matplotlib takes a second to load

    path = output_folder(out or folder_of(runs)) / "payload.png"
    picture.save(_panels(payload, arm, found), f"payload at {arm.robot.tip}", path)
    console.print(f"wrote {path}", soft_wrap=True)


def _say(payload: Payload, arm: Arm, console: Console) -> None:
    table = Table("", "value", "std. deviation", "unit", title=f"payload at {arm.robot.tip}")
    rows = [("mass", payload.mass_kg, payload.mass_std, "kg")]
    for i, axis in enumerate("xyz"):
        rows.append((f"centre {axis}", payload.com_m[i], payload.com_std[i], "m"))
    names = arm.robot.joint_names if len(payload.offsets) else []
    for name, value, std in zip(names, payload.offsets, payload.offsets_std, strict=True):
        rows.append((f"offset {name}", value, std, "N m"))
    for name, value, std, unit in rows:
        table.add_row(name, f"{value:.4f}", f"{std:.4f}", unit)
    console.print(table)
    console.print(
        f"{payload.poses} poses, condition number {payload.condition:.1f}, "
        f"{payload.residual_rms:.3f} N m rms unexplained",
    )


def _panels(payload: Payload, arm: Arm, found: StaticPoses) -> list[Panel]:
    parameters = payload.mass_kg * np.array([1.0, *payload.com_m])
    model = np.array(
        [regressor(arm.robot.chain, q, arm.robot.gravity) @ parameters for q in found.q]
    )
    if len(payload.offsets):
        model = model + payload.offsets
    panels = []
    for i, joint in enumerate(arm.joints):
        ends = np.array([model[:, i].min(), model[:, i].max()])
        line = {"this payload": (ends, ends)}
        x_label, y_label = "torque of the payload model (N m)", "torque beyond the arm's (N m)"
        panels.append(Panel(joint.name, x_label, y_label, model[:, i], found.tau[:, i], line))
    return panels
