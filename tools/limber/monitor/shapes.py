"""What an arm looks like: the visuals of its URDF, or, for links without any, limbs from joint to
joint.
"""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np
import trimesh

from limber.model.robot import Robot
from limber.model.urdf import MOVING, Joint, carrier
from limber.model.xml_file import attribute, inside, numbers_of, origin_pose, read_xml

LIMB, JOINT, TIP = (222, 226, 232), (62, 70, 84), (240, 140, 45)
THICKNESS = (0.062, 0.034)  # radius of the limbs at shoulder and tip over the arm's reach
LEAST_LIMB_M = 0.004
BUSY_FACES = 40_000  # a mesh with more slows the browser


@dataclass(frozen=True)
class Shape:
    """A mesh, in the frame of `link`."""

    link: str
    mesh: trimesh.Trimesh
    color: tuple[int, int, int]


@dataclass
class Figure:
    """`links`: base and the child links of the chain's moving joints, in order, with their joints.
    `troubles`: visuals that could not be drawn.
    """

    base: str
    joints: list[Joint]
    X_PF: list[np.ndarray]  # of each joint's frame in the link before it, 4x4
    X_tip: np.ndarray  # tip in the last link
    shapes: list[Shape] = field(default_factory=list)
    troubles: list[str] = field(default_factory=list)
    reach_m: float = 1.0

    @property
    def links(self) -> list[str]:
        return [self.base, *(joint.child for joint in self.joints)]


def figure(robot: Robot) -> Figure:
    made = _skeleton(robot)
    visuals = _visuals(robot, made)
    drawn = {shape.link for shape in visuals}
    limbs = [shape for shape in _limbs(robot, made) if shape.link not in drawn]
    made.shapes = [*visuals, *limbs]
    return made


def _skeleton(robot: Robot) -> Figure:
    """Fixed joints are folded into the moving joint behind them, or into the tip."""
    joints, poses, X = [], [], np.eye(4)
    for joint in robot.chain.joints:
        X = X @ joint.X_PF
        if joint.kind in MOVING:
            joints.append(joint)
            poses.append(X)
            X = np.eye(4)
    lengths = [np.linalg.norm(pose[:3, 3]) for pose in [*poses[1:], X]]
    return Figure(robot.base, joints, poses, X, reach_m=max(float(sum(lengths)), 0.1))


def _visuals(robot: Robot, made: Figure) -> list[Shape]:
    shapes: list[Shape] = []
    urdf, root = robot.urdf, read_xml(robot.urdf)
    materials = {m.get("name"): m for m in root.findall("material")}
    for link in root.findall("link"):
        name = attribute(link, "name", urdf)
        owner, X = carrier(name, made.links, robot.frames)
        if owner is None:
            continue
        for visual in link.findall("visual"):
            try:
                mesh = _mesh(inside(visual, "geometry", urdf), urdf)
            except Exception as error:  # trimesh raises whatever its file readers raise
                made.troubles.append(f"visual of {name}: {error}")
                continue
            mesh.apply_transform(X @ origin_pose(visual))
            shapes.append(Shape(owner, mesh, _color(visual, materials)))
    return shapes


def _mesh(geometry: Element, urdf: Path) -> trimesh.Trimesh:
    if (box := geometry.find("box")) is not None:
        return _made("box", numbers_of(box, "size", "0 0 0"))
    if (cylinder := geometry.find("cylinder")) is not None:
        return _made("cylinder", *_round(cylinder), sections=32)
    if (capsule := geometry.find("capsule")) is not None:
        radius, length = _round(capsule)  # of the cylinder between its two half balls
        end = np.array([0.0, 0.0, 0.5 * length])
        return _hull(-end, end, radius, radius, 2)
    if (sphere := geometry.find("sphere")) is not None:
        return _made("icosphere", 2, numbers_of(sphere, "radius", "0")[0])
    element = inside(geometry, "mesh", urdf)
    path = _mesh_file(attribute(element, "filename", urdf), urdf)
    mesh = trimesh.load_mesh(path)
    if len(mesh.faces) > BUSY_FACES:
        raise ValueError(f"{path.name} has {len(mesh.faces)} faces; up to {BUSY_FACES} are drawn")
    mesh.apply_scale(numbers_of(element, "scale", "1 1 1"))
    return mesh


def _made(kind: str, *sizes: Any, **more: Any) -> trimesh.Trimesh:
    """By trimesh's maker of this name, none of which has types."""
    mesh: trimesh.Trimesh = getattr(trimesh.creation, kind)(*sizes, **more)
    return mesh


def _round(element: Element) -> tuple[float, float]:
    radius, length = (float(numbers_of(element, key, "0")[0]) for key in ("radius", "length"))
    return radius, length


def _mesh_file(name: str, urdf: Path) -> Path:
    """package://PACKAGE/PATH: beside the URDF, or in a folder above it."""
    relative = Path(name.removeprefix("package://").removeprefix("file://"))
    tails = [relative, Path(*relative.parts[1:])] if "package://" in name else [relative]
    for folder in urdf.resolve().parents:
        for tail in tails:
            if (folder / tail).is_file():
                return folder / tail
    raise FileNotFoundError(f"{name} is not beside {urdf.name} nor above it")


def _color(visual: Element, materials: dict[str | None, Element]) -> tuple[int, int, int]:
    material = visual.find("material")
    for element in (
        material,
        materials.get(material.get("name")) if material is not None else None,
    ):
        color = element.find("color") if element is not None else None
        if color is not None:
            red, green, blue = np.clip(numbers_of(color, "rgba", "1 1 1 1")[:3] * 255, 0, 255)
            return int(red), int(green), int(blue)
    return LIMB


def _limbs(robot: Robot, made: Figure) -> list[Shape]:
    """A housing at each joint and a tapering limb to the next one."""
    thick, thin = (share * made.reach_m for share in THICKNESS)
    radii = np.linspace(thick, thin, len(made.joints) + 1)
    ends = [*made.X_PF, made.X_tip]
    shapes = _base(made, float(radii[0]), robot)
    for i, joint in enumerate(made.joints):
        r, to = float(radii[i]), ends[i + 1][:3, 3]
        shapes.append(Shape(joint.child, _housing(joint, r), JOINT))
        if np.linalg.norm(to) > LEAST_LIMB_M:
            shapes.append(Shape(joint.child, _limb(to, 0.82 * r, 0.82 * radii[i + 1]), LIMB))
    flange = _made("cylinder", 0.8 * thin, 0.5 * thin, sections=32)
    flange.apply_transform(made.X_tip)
    return [*shapes, Shape(made.links[-1], flange, TIP)]


def _base(made: Figure, r: float, robot: Robot) -> list[Shape]:
    """A foot, and a column from it to the first joint."""
    up = -robot.gravity if np.linalg.norm(robot.gravity) > 0 else np.array([0.0, 0.0, 1.0])
    foot = _made("cylinder", 1.8 * r, 0.4 * r, sections=48)
    foot.apply_transform(trimesh.geometry.align_vectors([0, 0, 1], up))
    to = made.X_PF[0][:3, 3]
    shapes = [Shape(made.base, foot, JOINT)]
    if np.linalg.norm(to) > LEAST_LIMB_M:
        shapes.append(Shape(made.base, _limb(to, 1.1 * r, 0.95 * r), LIMB))
    return shapes


def _housing(joint: Joint, r: float) -> trimesh.Trimesh:
    if joint.kind == "prismatic":
        mesh = _made("box", [1.8 * r, 1.8 * r, 2.4 * r])
    else:
        mesh = _made("cylinder", r, 2.3 * r, sections=40)
    mesh.apply_transform(trimesh.geometry.align_vectors([0, 0, 1], joint.axis))
    return mesh


def _limb(to: np.ndarray, r_from: float, r_to: float) -> trimesh.Trimesh:
    """From the origin to `to`."""
    return _hull(np.zeros(3), to, r_from, r_to, 3)


def _hull(
    one: np.ndarray, other: np.ndarray, r_one: float, r_other: float, fineness: int
) -> trimesh.Trimesh:
    """The hull of two balls, by their centres."""
    near, far = (_made("icosphere", fineness, r) for r in (r_one, r_other))
    points = np.vstack([near.vertices + one, far.vertices + other])
    hull: trimesh.Trimesh = trimesh.convex.convex_hull(points)
    return hull
