"""A robot folder as a model for MuJoCo (MJCF): bodies, rotors, friction, limits, motors.

One body a moving joint, as limber lumps them, in the frame of the joint's child link; MuJoCo's
world is the arm's base. Of robot.yaml: armature = n² B, damping = viscous and frictionloss =
Coulomb friction on both sides of the transmission, range and forcerange = the tightest limits. What
MuJoCo's joints do not have is left out and said in a comment: breakaway, Stribeck speeds, springs
between motor and link, geometry.
Element and attribute names: MuJoCo's XML reference.
"""

import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import numpy as np

from limber.errors import InputError
from limber.model.bodies import Body
from limber.model.robot import Robot
from limber.model.rotations import quaternion_of
from limber.model.urdf import MOVING
from limber.output import write_again

LEAST_MASS = 1e-6  # kg; MuJoCo wants every moving body to have one
SPRINGS = "springs between motor and link: motors and links are one, with B as armature"
SECOND_MOTOR = "the second motor of a joint"
BREAKAWAY = "breakaway friction"
FRICTIONS = ("friction", "link_friction")


def text(robot: Robot) -> str:
    """Throws InputError if a joint has no torque limit that MuJoCo could be given."""
    root = ElementTree.Element("mujoco", model=robot.name)
    root.append(ElementTree.Comment(_comment(robot)))
    ElementTree.SubElement(root, "compiler", angle="radian", autolimits="true")
    step_s = f"{1.0 / robot.rate_hz:.9g}"
    gravity = _numbers(robot.gravity)
    ElementTree.SubElement(
        root, "option", timestep=step_s, gravity=gravity, integrator="implicitfast"
    )
    world = ElementTree.SubElement(root, "worldbody")
    _bodies(robot, world)
    actuators = ElementTree.SubElement(root, "actuator")
    for joint in robot.joints:
        if not np.isfinite(joint.torque):
            raise InputError(f"{joint.name}: neither robot.yaml nor the URDF limits its torque")
        span = f"{-joint.torque:.6g} {joint.torque:.6g}"
        ElementTree.SubElement(
            actuators, "motor", name=joint.name, joint=joint.name, ctrlrange=span, forcerange=span
        )
    keyframe = ElementTree.SubElement(root, "keyframe")
    ElementTree.SubElement(keyframe, "key", name="home", qpos=_numbers(robot.home))
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"


def write(robot: Robot, out: Path) -> None:
    write_again(out, text(robot))


def left_out(robot: Robot) -> list[str]:
    """What of robot.yaml the model does not have."""
    joints = robot.resolved["joints"]
    breakaway = any(
        joint[side]["static_Nm"] > joint[side]["coulomb_Nm"]
        for joint in joints
        for side in FRICTIONS
    )
    found = {
        SPRINGS: any(joint["transmission"] != "rigid" for joint in joints),
        SECOND_MOTOR: any(joint["motors"] > 1 for joint in joints),
        BREAKAWAY: breakaway,
    }
    return [what for what, there in found.items() if there]


def _comment(robot: Robot) -> str:
    missing = left_out(robot)
    words = f" From robot.yaml and {robot.urdf.name} of {robot.name} by limber. "
    return words + (f"Left out: {'; '.join(missing)}. " if missing else "")


def _bodies(robot: Robot, parent: ElementTree.Element) -> None:
    """The chain from the base to the tip; fixed joints only move the next frame."""
    bodies, infos, found = iter(robot.bodies), iter(robot.joints), iter(robot.resolved["joints"])
    X = np.eye(4)
    for joint in robot.chain.joints:
        X = X @ joint.X_PF
        if joint.kind not in MOVING:
            continue
        parent = ElementTree.SubElement(parent, "body", {"name": joint.child, **_pose(X)})
        _inertial(next(bodies), parent)
        element, info = _joint(next(found), joint.axis, parent), next(infos)
        if np.isfinite([info.low, info.high]).all():
            element.set("range", _numbers([info.low, info.high]))
        X = np.eye(4)
    ElementTree.SubElement(parent, "site", {"name": robot.tip, "size": "0.01", **_pose(X)})


def _joint(
    found: dict[str, Any], axis: np.ndarray, parent: ElementTree.Element
) -> ElementTree.Element:
    coulomb, viscous = (
        sum(found[side][key] for side in FRICTIONS) for key in ("coulomb_Nm", "viscous_Nms_per_rad")
    )
    return ElementTree.SubElement(
        parent,
        "joint",
        name=found["name"],
        type="slide" if found["type"] == "prismatic" else "hinge",
        axis=_numbers(axis),
        armature=f"{found['rotor_inertia_kgm2']:.6g}",
        damping=f"{viscous:.6g}",
        frictionloss=f"{coulomb:.6g}",
    )


def _inertial(body: Body, parent: ElementTree.Element) -> None:
    """About the centre of mass, in the body's axes."""
    mass = max(body.mass, LEAST_MASS)
    com = body.moment / mass
    inertia = body.inertia - mass * (com @ com * np.eye(3) - np.outer(com, com))
    if not body.mass > LEAST_MASS:
        inertia = LEAST_MASS * np.eye(3)
    xx, yy, zz = np.diag(inertia)
    full = [xx, yy, zz, inertia[0, 1], inertia[0, 2], inertia[1, 2]]
    ElementTree.SubElement(
        parent, "inertial", pos=_numbers(com), mass=f"{mass:.9g}", fullinertia=_numbers(full)
    )


def _pose(X: np.ndarray) -> dict[str, str]:
    w, x, y, z = quaternion_of(X[:3, :3])
    return {"pos": _numbers(X[:3, 3]), "quat": _numbers([w, x, y, z])}


def _numbers(values: np.ndarray | list[float]) -> str:
    return " ".join(f"{float(value):.9g}" for value in values)
