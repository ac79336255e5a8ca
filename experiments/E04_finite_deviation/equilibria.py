"""Where a form of Eq. 7 comes to rest under a force, and beyond which force it does not."""

import numpy as np

from limber.errors import RunError
from limber.experiments import planar2r as arm
from limber.experiments.context import Context

from .laws import ALONG, P_D, Form, asked, closed, name

STEP = 1e-5  # rad, of differences


def equilibrium(context: Context, form: Form, force: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Newton on τ(q) + Jᵀ F = 0 with differences of the controller's torques."""
    q = start
    for _ in range(12):
        axes = np.vstack([np.zeros(2), STEP * np.eye(2), -STEP * np.eye(2)])
        tau = asked(context, [(form, q + axis) for axis in axes])
        total = [t + arm.jacobian(q + a).T @ force for t, a in zip(tau, axes, strict=True)]
        slope = np.column_stack([total[1] - total[3], total[2] - total[4]]) / (2 * STEP)
        step = np.linalg.solve(slope, total[0])
        if not np.all(np.isfinite(step)) or np.abs(step).max() > 0.5:
            break
        q = q - step
        if np.abs(step).max() < 1e-9:
            return q
    raise RunError(f"{name(form)} finds no rest under {np.linalg.norm(force):.3g} N")


def carried(context: Context, form: Form, beyond: float) -> np.ndarray:
    """Deviation, m, and load, N, along ALONG: the load grows until Newton, started at the rest
    before, finds none.
    """
    q, load, step = arm.inverse(P_D), 0.0, beyond / 12
    found = [(0.0, 0.0)]
    while step > beyond * 5e-3:
        try:
            q = equilibrium(context, form, (load + step) * ALONG, q)
        except (RunError, np.linalg.LinAlgError):
            step /= 2
            continue
        load += step
        found.append((float((arm.tip(q) - P_D) @ ALONG), load))
    return np.array(found)


def rest(context: Context, form: Form, load: float) -> np.ndarray:
    """The rest that grows out of the target with the load."""
    q = arm.inverse(P_D)
    for part in np.linspace(0.25, 1.0, 4):
        q = equilibrium(context, form, part * load * ALONG, q)
    return q


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
