"""Forward kinematics and Jacobian of a serial arm, from the joint frames of its URDF.

The frames are those that limber-check resolves; what is made of them is independent of the C++
chain on purpose: what `limber` measures shall not lean on the code it measures.
"""

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

import numpy as np

from limber.arrays import Floats
from limber.model.rotations import matrix_of, turned_about

MOVING = ("revolute", "continuous", "prismatic")


@dataclass(frozen=True)
class Joint:
    """`X_PF`: 4x4, joint frame in the parent link at zero. `axis`: unit, joint frame; of a joint
    that moves. Joints that are no part of the arm are "fixed", at zero.
    """

    name: str
    kind: str
    parent: str
    child: str
    X_PF: Floats
    axis: Floats


class Chain:
    """The joints from `base` to `tip`, in order; `joint_names` are those that move."""

    def __init__(self, joints: dict[str, Joint], base: str, tip: str) -> None:
        """`joints`: by the name of their child link, as joints_of() gives them."""
        self.joints: list[Joint] = []
        while tip != base:
            self.joints.insert(0, joints[tip])
            tip = joints[tip].parent
        self.joint_names = [joint.name for joint in self.joints if joint.kind in MOVING]

    def forward(self, q: Floats) -> Floats:
        """X_BT, 4x4."""
        return self._frames(q)[0]

    def jacobian(self, q: Floats) -> Floats:
        """J_BT, 6xn: twist [v; w] of the tip in base axes, tip origin as reference point."""
        X_BT, axes = self._frames(q)
        columns = []
        for kind, X_BJ, axis in axes:
            a = X_BJ[:3, :3] @ axis
            if kind == "prismatic":
                columns.append(np.concatenate([a, np.zeros(3)]))
            else:
                columns.append(np.concatenate([np.cross(a, X_BT[:3, 3] - X_BJ[:3, 3]), a]))
        return np.array(columns).T.reshape(6, -1)

    def _frames(self, q: Floats) -> tuple[Floats, list[tuple[str, Floats, Floats]]]:
        X: Floats = np.eye(4)
        axes: list[tuple[str, Floats, Floats]] = []
        values = iter(np.asarray(q, float)[: len(self.joint_names)])
        for joint in self.joints:
            X = X @ joint.X_PF
            if joint.kind not in MOVING:
                continue
            axes.append((joint.kind, X, joint.axis))
            X = X @ _motion(joint, next(values))
        return X, axes


def joints_of(tree: dict[str, Any]) -> dict[str, Joint]:
    """Of limber-check's `tree`, by the name of their child link."""
    return {entry["child"]: _joint(entry) for entry in tree["joints"]}


def pose_of(entry: dict[str, Any]) -> Floats:
    """4x4."""
    X = np.eye(4)
    X[:3, :3] = matrix_of(np.roll(entry["quat_xyzw"], 1))
    X[:3, 3] = entry["p_m"]
    return X


def carrier(
    link: str, links: Collection[str], joints: dict[str, Joint]
) -> tuple[str | None, Floats]:
    """Which of `links` carries `link` with all joints between them at zero, and the pose of `link`
    in it, 4x4; None if none does.
    """
    X = np.eye(4)
    while link not in links:
        if link not in joints:
            return None, X
        X = joints[link].X_PF @ X
        link = joints[link].parent
    return link, X


def _joint(entry: dict[str, Any]) -> Joint:
    axis = np.array(entry["axis"], float)
    length = float(np.linalg.norm(axis))
    axis = axis / length if length > 0 else axis
    return Joint(
        entry["name"], entry["type"], entry["parent"], entry["child"], pose_of(entry), axis
    )


def _motion(joint: Joint, value: float) -> Floats:
    X = np.eye(4)
    if joint.kind == "prismatic":
        X[:3, 3] = value * joint.axis
    else:
        X[:3, :3] = turned_about(value * joint.axis)
    return X
