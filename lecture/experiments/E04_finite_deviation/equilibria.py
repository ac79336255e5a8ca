"""Where a form of Eq. 7 comes to rest under a force, and beyond which force it does not."""

from dataclasses import dataclass

import numpy as np

from limber_lecture import planar2r as arm
from limber_lecture.context import Context

from .laws import ALONG, P_D, Form, asked, closed

STEP = 1e-5  # rad, of differences


@dataclass(frozen=True)
class Task:
    """A form of Eq. 7 under a force on the tip, N, and where to start looking."""

    form: Form
    force: np.ndarray
    start: np.ndarray


def rests(context: Context, tasks: list[Task]) -> list[np.ndarray]:
    """Newton on τ(q) + Jᵀ F = 0 for all tasks at once; NaN where it does not settle."""
    poses = [task.start for task in tasks]
    moving = list(range(len(tasks)))
    for _ in range(12):
        steps = newton_steps(context, [(tasks[i], poses[i]) for i in moving])
        for i, step in zip(moving, steps, strict=True):
            poses[i] = poses[i] - step
        sizes = [np.abs(step).max() for step in steps]
        moving = [i for i, size in zip(moving, sizes, strict=True) if size > 1e-9]
        if not moving:
            return poses
    return [q if i not in moving else q * np.nan for i, q in enumerate(poses)]


def newton_steps(context: Context, at: list[tuple[Task, np.ndarray]]) -> list[np.ndarray]:
    """With differences of the controller's torques. A step beyond half a radian is no step: NaN."""
    axes = np.vstack([np.zeros(2), STEP * np.eye(2), -STEP * np.eye(2)])
    points = [(task, q + axis) for task, q in at for axis in axes]
    torques = asked(context, [(task.form, q) for task, q in points])
    pushed = [arm.jacobian(q).T @ task.force for task, q in points]
    totals = (torques + np.array(pushed)).reshape(len(at), len(axes), 2)
    steps = []
    for total in totals:
        slope = np.column_stack([total[1] - total[3], total[2] - total[4]]) / (2 * STEP)
        step = np.linalg.lstsq(slope, total[0], rcond=None)[0]
        steps.append(step if np.abs(step).max() < 0.5 else step * np.nan)
    return steps


def carried(context: Context, form: Form, beyond: float) -> np.ndarray:
    """Deviation, m, and load, N, along ALONG: the load grows until Newton, started at the rest
    before, finds none.
    """
    q, load, step = arm.inverse(P_D), 0.0, beyond / 12
    found = [(0.0, 0.0)]
    while step > beyond * 5e-3:
        (next_q,) = rests(context, [Task(form, (load + step) * ALONG, q)])
        if np.isnan(next_q).any():
            step /= 2
            continue
        q, load = next_q, load + step
        found.append((float((arm.tip(q) - P_D) @ ALONG), load))
    return np.array(found)


def closed_curve(form: Form, reach: float) -> np.ndarray:
    """The same curve in closed form, followed by its tangent from the target to `reach`, or over
    the top of the load until it has fallen by a tenth.
    """
    q, load, direction = arm.inverse(P_D), 0.0, np.array([0.0, 0.0, 1.0])
    found = [(0.0, 0.0)]
    top = 0.0
    while found[-1][0] < reach and load >= 0.9 * top:
        slope = arm.derivative(lambda x: closed(form, x), q) + arm.geometric(q, load * ALONG)
        system = np.column_stack([slope, arm.jacobian(q).T @ ALONG])
        tangent = np.linalg.svd(system)[2][-1]
        tangent *= np.sign(tangent @ direction)
        scale = 1e-3 / np.linalg.norm(tangent[:2])
        q, load, direction = q + scale * tangent[:2], load + scale * tangent[2], tangent
        off = closed(form, q) + load * arm.jacobian(q).T @ ALONG
        correction = np.linalg.lstsq(system, -off, rcond=None)[0]
        q, load = q + correction[:2], load + correction[2]
        top = max(top, load)
        found.append((float((arm.tip(q) - P_D) @ ALONG), float(load)))
    return np.array(found)
