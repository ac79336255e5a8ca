"""Which way a joint turns, in words that somebody beside the arm can follow."""

import numpy as np

from limber.arrays import Floats
from limber.model.robot import Robot
from limber.model.urdf import MOVING

AXES = (("forward", "back"), ("left", "right"), ("up", "down"))  # of a base whose z points up
LETTERS = "xyz"
SIDE = 0.4  # of the longest component: what is shorter is not named
VERTICAL = 0.9
SEEN_M = 0.01  # a way of the tip that can be seen


def direction_words(v: Floats, gravity: Floats) -> str:
    """Such as "forward (+x) and up (+z)", base axes, the longest component first."""
    length = np.abs(v)
    named = [int(i) for i in np.argsort(-length, kind="stable") if length[i] > SIDE * length.max()]
    *first, last = (_axis_word(i, v[i] > 0, gravity) for i in named)
    return f"{', '.join(first)} and {last}" if first else last


def _axis_word(axis: int, positive: bool, gravity: Floats) -> str:
    letter = f"{'+' if positive else '-'}{LETTERS[axis]}"
    weight = float(np.linalg.norm(gravity))
    upright = -gravity / weight if weight > 0 else np.zeros(3)
    if upright[2] > VERTICAL:
        return f"{AXES[axis][0 if positive else 1]} ({letter})"
    if abs(upright[axis]) > VERTICAL:
        return f"{'up' if (upright[axis] > 0) == positive else 'down'} ({letter})"
    return f"along {letter}"


def slides(robot: Robot) -> list[bool]:
    """True for each prismatic joint."""
    return [joint.kind == "prismatic" for joint in robot.chain.joints if joint.kind in MOVING]


def amount_words(amount: float, slide: bool) -> str:
    """Without a sign."""
    if slide:
        return f"{1e3 * abs(amount):.0f} mm"
    return f"{abs(amount):.2g} rad ({np.degrees(abs(amount)):.0f}°)"


def motion_words(robot: Robot, joint: int, q: Floats, change: float) -> str:
    """What a hand is to do for this change of a joint at this pose, and what moves where."""
    axis = robot.dynamics.frames(q[None]).z[joint, 0]
    pointing = direction_words(axis, robot.gravity)
    if slides(robot)[joint]:
        way = "along" if change > 0 else "against"
        return (
            f"by {amount_words(change, True)} {way} its axis, which points {pointing}: "
            f"{_moves(robot, joint, q, change)}"
        )
    way = "counter-clockwise" if change > 0 else "clockwise"
    return (
        f"by {amount_words(change, False)} {way}, seen with its axis, which points {pointing}, "
        f"towards you: {_moves(robot, joint, q, change)}"
    )


def _moves(robot: Robot, joint: int, q: Floats, change: float) -> str:
    there = np.array(q, float)
    there[joint] += change
    before, after = (robot.chain.forward(pose)[:3, 3] for pose in (q, there))
    way = after - before
    if np.linalg.norm(way) >= SEEN_M:
        return f"the tip moves {_way_words(way, robot.gravity)}"
    link = _child(robot, joint)
    way = _centre(robot, joint, there) - _centre(robot, joint, q)
    if np.linalg.norm(way) >= SEEN_M:
        return f"the tip hardly moves, {link} moves {_way_words(way, robot.gravity)}"
    return f"the tip stays where it is; {_turned_side(robot, joint, q, change)}"


def _way_words(way: Floats, gravity: Floats) -> str:
    far = float(np.linalg.norm(way))
    length = f"{100 * far:.0f} cm" if far >= 0.03 else f"{1e3 * far:.0f} mm"
    return f"{direction_words(way, gravity)}, {length}"


def _child(robot: Robot, joint: int) -> str:
    return [j.child for j in robot.chain.joints if j.kind in MOVING][joint]


def _centre(robot: Robot, joint: int, q: Floats) -> Floats:
    """Centre of mass of what is between this joint and the next, base axes."""
    frames, body = robot.dynamics.frames(q[None]), robot.dynamics.bodies[joint]
    centre = body.moment / body.mass if body.mass > 0 else np.zeros(3)
    found: Floats = frames.p[joint, 0] + frames.R[joint, 0] @ centre
    return found


def _turned_side(robot: Robot, joint: int, q: Floats, change: float) -> str:
    """That axis of the tip which is farthest from the joint's, and where its end goes."""
    z = robot.dynamics.frames(q[None]).z[joint, 0]
    R = robot.chain.forward(q)[:3, :3]
    side = int(np.argmin(np.abs(R.T @ z)))
    towards = np.cross(z, R[:, side]) * np.sign(change)
    points, goes = (direction_words(v, robot.gravity) for v in (R[:, side], towards))
    return f"its {LETTERS[side]} axis, which points {points}, turns towards {goes}"
