"""Forward kinematics and Jacobian of a serial arm, straight from its URDF.

Independent of the C++ chain on purpose: what `limber` measures shall not lean on the code it
measures.
"""

from collections.abc import Collection
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from limber.arrays import Floats
from limber.errors import InputError
from limber.model.rotations import matrix_of, turned_about
from limber.model.xml_file import attribute, inside, read_xml

MOVING = ("revolute", "continuous", "prismatic")


@dataclass(frozen=True)
class Joint:
    """Numbers are read when they are needed: elsewhere in the file they may be wrong."""

    name: str
    kind: str
    parent: str
    child: str
    element: Element

    @cached_property
    def X_PF(self) -> Floats:
        """4x4, joint frame in the parent link at zero."""
        return pose_of(self.element.find("origin"))

    @cached_property
    def axis(self) -> Floats:
        """Unit, joint frame; of a joint that moves."""
        axis = numbers_of(self.element.find("axis"), "xyz", "1 0 0")
        return axis / np.linalg.norm(axis)

    @cached_property
    def limits(self) -> tuple[float, float]:
        """Of the position; infinite for continuous joints, and where both are 0 or absent."""
        limit = self.element.find("limit") if self.kind != "continuous" else None
        low, high = (numbers_of(limit, key, "0")[0] for key in ("lower", "upper"))
        return (low, high) if low or high else (-np.inf, np.inf)

    def most(self, key: str) -> float:
        """`velocity` or `effort` of its <limit>; infinite where it is absent or zero."""
        return float(numbers_of(self.element.find("limit"), key, "0")[0]) or np.inf


class Chain:
    """The joints from `base` to `tip`, in order; `joint_names` are those that move.

    `R_RB` turns base axes into those of the URDF's root link, every joint between at zero.
    """

    def __init__(self, urdf: Path, base: str, tip: str) -> None:
        joints = read_joints(urdf)
        self.joints = _path_between(joints, base, tip, urdf)
        self.R_RB = _rotation_of(joints, base)
        self.joint_names = [joint.name for joint in self.joints if joint.kind in MOVING]

    def joint(self, name: str) -> Joint:
        return next(joint for joint in self.joints if joint.name == name)

    def limits(self, name: str) -> tuple[float, float]:
        return self.joint(name).limits

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


def _motion(joint: Joint, value: float) -> Floats:
    X = np.eye(4)
    if joint.kind == "prismatic":
        X[:3, 3] = value * joint.axis
    else:
        X[:3, :3] = turned_about(value * joint.axis)
    return X


def numbers_of(element: Element | None, key: str, default: str) -> Floats:
    text = element.get(key, default) if element is not None else default
    return np.array([float(part) for part in text.split()])


def pose_of(origin: Element | None) -> Floats:
    """4x4, of an <origin>: rpy turns by roll about x, then pitch about y, then yaw about z, all of
    the parent's axes; quat_xyzw, of URDF 1.1, stands in its place.
    """
    X = np.eye(4)
    X[:3, 3] = numbers_of(origin, "xyz", "0 0 0")
    if origin is not None and origin.get("quat_xyzw") is not None:
        X[:3, :3] = matrix_of(np.roll(numbers_of(origin, "quat_xyzw", ""), 1))
    else:
        roll, pitch, yaw = np.diag(numbers_of(origin, "rpy", "0 0 0"))
        X[:3, :3] = turned_about(yaw) @ turned_about(pitch) @ turned_about(roll)
    return X


def read_joints(urdf: Path) -> dict[str, Joint]:
    """Joints by the name of their child link."""
    found = {}
    for element in read_xml(urdf).findall("joint"):
        name, kind = (attribute(element, key, urdf) for key in ("name", "type"))
        parent, child = (
            attribute(inside(element, key, urdf), "link", urdf) for key in ("parent", "child")
        )
        found[child] = Joint(name, kind, parent, child, element)
    return found


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


def _path_between(joints: dict[str, Joint], base: str, tip: str, urdf: Path) -> list[Joint]:
    path = []
    link = tip
    while link != base:
        if link not in joints:
            raise InputError(f"{urdf}: no chain of joints leads from link '{base}' to link '{tip}'")
        path.append(joints[link])
        link = joints[link].parent
    return path[::-1]


def _rotation_of(joints: dict[str, Joint], link: str) -> Floats:
    """Axes of a link in those of the root link."""
    R = np.eye(3)
    while link in joints:
        R = joints[link].X_PF[:3, :3] @ R
        link = joints[link].parent
    return R
