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

import numpy as np

from limber.errors import InputError
from limber.identify.arm import Arm, JointBelief
from limber.model.bodies import Body
from limber.model.rotations import quaternion_of
from limber.model.urdf import MOVING
from limber.output import write_again

LEAST_MASS = 1e-6  # kg; MuJoCo wants every moving body to have one
LEFT_OUT = {
    "static_Nm": "breakaway friction",
    "transmission": "springs between motor and link: motors and links are one, with B as armature",
    "antagonist": "the second motor of a joint",
}


def text(arm: Arm) -> str:
    """Throws InputError if a joint has no torque limit that MuJoCo could be given."""
    robot = arm.robot
    root = ElementTree.Element("mujoco", model=robot.name)
    root.append(ElementTree.Comment(_comment(arm)))
    ElementTree.SubElement(root, "compiler", angle="radian", autolimits="true")
    step_s = f"{1.0 / robot.rate_hz:.9g}"
    gravity = _numbers(robot.gravity)
    ElementTree.SubElement(
        root, "option", timestep=step_s, gravity=gravity, integrator="implicitfast"
    )
    world = ElementTree.SubElement(root, "worldbody")
    _bodies(arm, world)
    actuators = ElementTree.SubElement(root, "actuator")
    for joint in arm.joints:
        limit = torque_limit(arm, joint)
        span = f"{-limit:.6g} {limit:.6g}"
        ElementTree.SubElement(
            actuators, "motor", name=joint.name, joint=joint.name, ctrlrange=span, forcerange=span
        )
    keyframe = ElementTree.SubElement(root, "keyframe")
    ElementTree.SubElement(keyframe, "key", name="home", qpos=_numbers(robot.home))
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"


def write(arm: Arm, out: Path) -> None:
    write_again(out, text(arm))


def left_out(arm: Arm) -> list[str]:
    """What of robot.yaml the model does not have."""
    found = []
    for joint in arm.joints:
        rigid = joint.transmission.get("kind", "rigid") == "rigid"
        found += [LEFT_OUT["transmission"]] if not rigid else []
        found += [LEFT_OUT["antagonist"]] if joint.two_motors else []
        for section in ("friction", "link_friction"):
            if joint.believed(section, joint.key("static_Nm")) is not None:
                found.append(LEFT_OUT["static_Nm"])
    return list(dict.fromkeys(found))


def _comment(arm: Arm) -> str:
    missing = left_out(arm)
    words = f" From {arm.yaml.name} and {arm.robot.urdf.name} of {arm.robot.name} by limber. "
    return words + (f"Left out: {'; '.join(missing)}. " if missing else "")


def _bodies(arm: Arm, parent: ElementTree.Element) -> None:
    """The chain from the base to the tip; fixed joints only move the next frame."""
    bodies, beliefs = iter(arm.robot.dynamics.bodies), iter(arm.joints)
    limits = iter(arm.robot.joints)
    X = np.eye(4)
    for joint in arm.robot.chain.joints:
        X = X @ joint.X_PF
        if joint.kind not in MOVING:
            continue
        parent = ElementTree.SubElement(parent, "body", {"name": joint.child, **_pose(X)})
        _inertial(next(bodies), parent)
        info = next(limits)
        element = _joint(next(beliefs), joint.axis, parent)
        if np.isfinite([info.low, info.high]).all():
            element.set("range", _numbers([info.low, info.high]))
        X = np.eye(4)
    ElementTree.SubElement(parent, "site", {"name": arm.robot.tip, "size": "0.01", **_pose(X)})


def _joint(
    belief: JointBelief, axis: np.ndarray, parent: ElementTree.Element
) -> ElementTree.Element:
    sections = ("friction", "link_friction")
    coulomb, viscous = (
        sum(belief.believed(section, belief.key(key)) or 0.0 for section in sections)
        for key in ("coulomb_Nm", "viscous_Nms_per_rad")
    )
    return ElementTree.SubElement(
        parent,
        "joint",
        name=belief.name,
        type="slide" if belief.prismatic else "hinge",
        axis=_numbers(axis),
        armature=f"{belief.rotor_inertia:.6g}",
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


def torque_limit(arm: Arm, joint: JointBelief) -> float:
    """The tightest of URDF, motor and joint, N m or N."""
    limit = next(info.torque for info in arm.robot.joints if info.name == joint.name)
    if not np.isfinite(limit):
        raise InputError(f"{joint.name}: neither robot.yaml nor the URDF limits its torque")
    return limit


def _pose(X: np.ndarray) -> dict[str, str]:
    w, x, y, z = quaternion_of(X[:3, :3])
    return {"pos": _numbers(X[:3, 3]), "quat": _numbers([w, x, y, z])}


def _numbers(values: np.ndarray | list[float]) -> str:
    return " ".join(f"{float(value):.9g}" for value in values)
