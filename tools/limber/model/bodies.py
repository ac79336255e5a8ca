"""What each moving joint of a chain carries: the masses of a URDF, lumped.

Links joined by fixed joints are one body; whatever branches off the chain belongs to the body it
hangs from, its own joints at zero. Links that do not move have no inertial.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from limber.arrays import Floats
from limber.model.urdf import MOVING, Chain, Joint, carrier, pose_of


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


def bodies(chain: Chain, joints: dict[str, Joint], inertials: dict[str, Inertial]) -> list[Body]:
    """One for each moving joint of the chain, in order. `joints`: all of the tree."""
    children = [joint.child for joint in chain.joints if joint.kind in MOVING]
    parts: dict[str, list[tuple[str, Inertial, Floats]]] = {child: [] for child in children}
    for link, inertial in inertials.items():
        owner, X = carrier(link, parts, joints)
        if owner is not None:
            parts[owner].append((link, inertial, X))
    return [_lump(child, parts[child]) for child in children]


def inertials_of(tree: dict[str, Any]) -> dict[str, Inertial]:
    """Of limber-check's `tree`, by link; those without mass and inertia are left out."""
    read = {entry["link"]: _inertial(entry) for entry in tree["inertials"]}
    return {link: found for link, found in read.items() if found.mass or found.inertia.any()}


def _inertial(entry: dict[str, Any]) -> Inertial:
    X, (xx, xy, xz, yy, yz, zz) = pose_of(entry), entry["xx_xy_xz_yy_yz_zz_kgm2"]
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return Inertial(entry["mass_kg"], X[:3, 3], X[:3, :3] @ inertia @ X[:3, :3].T)


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
