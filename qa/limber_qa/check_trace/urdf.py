"""Limits of an arm's joints, read from its URDF by the referee itself."""

import math
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element

from limber.errors import InputError
from limber.model.xml_file import attribute, inside, read_xml


@dataclass(frozen=True)
class Limits:
    """Rad, rad/s and N m, or m, m/s and N; infinite where the URDF has none, or zero."""

    low: float = -math.inf
    high: float = math.inf
    velocity: float = math.inf
    effort: float = math.inf


def joint_limits(urdf: Path, base: str, tip: str) -> dict[str, Limits]:
    """Of the joints that move between base and tip, in order. Raises InputError."""
    above = {
        attribute(inside(joint, "child", urdf), "link", urdf): joint
        for joint in read_xml(urdf).findall("joint")
    }
    path: list[Element] = []
    while tip != base:
        if tip not in above:
            raise InputError(f"{urdf}: no chain of joints leads from '{base}' to '{tip}'")
        path.insert(0, above[tip])
        tip = attribute(inside(above[tip], "parent", urdf), "link", urdf)
    return {
        attribute(joint, "name", urdf): _limits(joint)
        for joint in path
        if joint.get("type") != "fixed"
    }


def _limits(joint: Element) -> Limits:
    limit = joint.find("limit")
    if limit is None:
        return Limits()
    low, high, velocity, effort = (
        float(limit.get(key, 0.0)) for key in ("lower", "upper", "velocity", "effort")
    )
    if joint.get("type") == "continuous" or low == high == 0.0:
        low, high = -math.inf, math.inf
    return Limits(low, high, velocity or math.inf, effort or math.inf)
