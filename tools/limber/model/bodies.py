"""What each moving joint of a chain carries: the masses of a URDF, lumped.

Links joined by fixed joints are one body; whatever branches off the chain belongs to the body it
hangs from, its own joints at zero. Links that do not move are not read.
"""

from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from limber.arrays import Floats
from limber.model.urdf import MOVING, Chain, carrier, numbers_of, pose_of, read_joints
from limber.model.xml_file import attribute, read_xml


@dataclass(frozen=True)
class Inertial:
    """Of one link, in its own frame: kg, m, kg m² about the centre of mass."""

    mass: float
    com: Floats
    inertia: Floats


@dataclass(frozen=True)
class Body:
    """Behind one moving joint, in the axes and from the origin of that joint's child link.

    `heaviest` is the link with the greatest mass in it, at `X_CH` of the child link, and `inertial`
    its inertial in the URDF.
    """

    mass: float  # kg
    moment: Floats  # mass times centre of mass, kg m
    inertia: Floats  # 3x3 about the origin, kg m²
    heaviest: str
    inertial: Inertial
    X_CH: Floats


def bodies(urdf: Path, chain: Chain) -> list[Body]:
    """One for each moving joint of the chain, in order."""
    joints = read_joints(urdf)
    children = [joint.child for joint in chain.joints if joint.kind in MOVING]
    parts: dict[str, list[tuple[str, Inertial, Floats]]] = {child: [] for child in children}
    for link, element in _inertial_elements(urdf):
        owner, X = carrier(link, parts, joints)
        if owner is None:
            continue
        inertial = _inertial(element)
        if inertial is not None:
            parts[owner].append((link, inertial, X))
    return [_lump(child, parts[child]) for child in children]


def read_inertials(urdf: Path) -> dict[str, Inertial]:
    """By link; links without mass and inertia are left out."""
    read = ((link, _inertial(element)) for link, element in _inertial_elements(urdf))
    return {link: inertial for link, inertial in read if inertial is not None}


def _inertial_elements(urdf: Path) -> list[tuple[str, Element]]:
    links = read_xml(urdf).findall("link")
    found = ((attribute(link, "name", urdf), link.find("inertial")) for link in links)
    return [(link, element) for link, element in found if element is not None]


def _inertial(element: Element) -> Inertial | None:
    mass = numbers_of(element.find("mass"), "value", "0")[0]
    X, tensor = pose_of(element.find("origin")), element.find("inertia")
    xx, xy, xz, yy, yz, zz = (
        numbers_of(tensor, key, "0")[0] for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    )
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if mass == 0 and not inertia.any():
        return None
    R = X[:3, :3]
    return Inertial(mass, X[:3, 3], R @ inertia @ R.T)


def _lump(child: str, parts: list[tuple[str, Inertial, Floats]]) -> Body:
    if not parts:  # a frame between two joints
        parts = [(child, Inertial(0.0, np.zeros(3), np.zeros((3, 3))), np.eye(4))]
    mass, moment, inertia = 0.0, np.zeros(3), np.zeros((3, 3))
    for _, part, X in parts:
        R, c = X[:3, :3], X[:3, :3] @ part.com + X[:3, 3]
        mass += part.mass
        moment += part.mass * c
        inertia += R @ part.inertia @ R.T + part.mass * (c @ c * np.eye(3) - np.outer(c, c))
    heaviest = max(parts, key=lambda part: part[1].mass)
    return Body(mass, moment, inertia, *heaviest)
