"""Whether a recording can be of the arm that it is read with: positions within the joints' ends,
speeds and torques within what the motors make, torques of the size that the weights need.

What lies beyond is refused, with the scale that would fit, if a usual unit does: nobody's friction
is made of degrees.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from limber.arrays import Flags, Floats
from limber.errors import InputError
from limber.identify.arm import Arm
from limber.identify.recording import Recording

BEYOND_ENDS = 0.1  # of the travel: a soft wall gives way, a zero is not exact
SLACK = 0.1  # rad or m
BEYOND_MOST = 1.5  # of the greatest torque or speed
SPEED_OVER_s = 0.05  # that speeds are taken over: encoders have steps
LEAST_SHARE = 0.01  # of the travel or the torque that a scale has to leave
ALIKE = 0.9  # correlation of torques with the weight from which on their ratio counts
FACTOR = 4.0  # by which a torque may differ from what the weights need
ROTARY = {"degrees": np.pi / 180.0, "milliradians": 1e-3}
SLIDING = {"millimetres": 1e-3, "centimetres": 1e-2}


@dataclass(frozen=True)
class Limits:
    """Of each joint, infinite where nobody knows: rad, rad/s, N m; m, m/s, N."""

    low: Floats
    high: Floats
    speed: Floats
    torque: Floats


def check(recordings: list[Recording], arm: Arm) -> list[str]:
    """What is doubtful. Raises InputError for what cannot be."""
    joints = arm.robot.joints
    limits = Limits(*np.array([(j.low, j.high, j.velocity, j.torque) for j in joints], float).T)
    q = np.concatenate([recording.q for recording in recordings])
    _require_positions(q, limits, arm)
    _require_speeds(recordings, limits, arm)
    doubts = []
    for name, values in _torques(recordings):
        _require_torques(name, values, q, limits, arm)
        doubts += _doubts(name, values, q, arm)
    return doubts


def _require_positions(q: Floats, limits: Limits, arm: Arm) -> None:
    margin = BEYOND_ENDS * (limits.high - limits.low) + SLACK
    bad = (q.min(axis=0) < limits.low - margin) | (q.max(axis=0) > limits.high + margin)
    if not bad.any():
        return

    def fits(i: int, scale: float) -> bool:
        low, high = scale * q[:, i].min(), scale * q[:, i].max()
        inside = limits.low[i] - margin[i] <= low and high <= limits.high[i] + margin[i]
        return bool(inside and high - low > LEAST_SHARE * (limits.high[i] - limits.low[i]))

    told = [
        f"{joint.name} from {q[:, i].min():.4g} to {q[:, i].max():.4g}, its ends are "
        f"{limits.low[i]:.4g} and {limits.high[i]:.4g} {'m' if joint.prismatic else 'rad'}"
        for i, joint in enumerate(arm.joints)
        if bad[i]
    ]
    raise InputError(
        f"position: {'; '.join(told)}: {_proposal('position', bad, fits, arm)}, or another zero?"
    )


def _require_speeds(recordings: list[Recording], limits: Limits, arm: Arm) -> None:
    fastest = np.max([_fastest(recording) for recording in recordings], axis=0)
    bad = fastest > BEYOND_MOST * limits.speed
    if not bad.any():
        return

    def fits(i: int, scale: float) -> bool:
        speed = scale * fastest[i]
        return bool(LEAST_SHARE * limits.speed[i] < speed < BEYOND_MOST * limits.speed[i])

    told = [
        f"{joint.name} at up to {fastest[i]:.4g}, its limit is {limits.speed[i]:.4g} "
        f"{'m/s' if joint.prismatic else 'rad/s'}"
        for i, joint in enumerate(arm.joints)
        if bad[i]
    ]
    raise InputError(
        f"position: {'; '.join(told)}: {_proposal('position', bad, fits, arm)}, or other times?"
    )


def _fastest(recording: Recording) -> Floats:
    steps = max(round(SPEED_OVER_s * recording.rate_hz), 1)
    moved = np.abs(recording.q[steps:] - recording.q[:-steps])
    fastest: Floats = np.percentile(moved, 99.9, axis=0) * recording.rate_hz / steps
    return fastest


def _torques(recordings: list[Recording]) -> list[tuple[str, Floats]]:
    found = []
    if all(recording.motor_known for recording in recordings):
        found.append(("motor_torque", np.concatenate([r.motor for r in recordings])))
    if all(recording.torque_sensor.all() for recording in recordings):
        found.append(("joint_torque", np.concatenate([r.tau for r in recordings])))
    return found


def _require_torques(name: str, values: Floats, q: Floats, limits: Limits, arm: Arm) -> None:
    most = np.abs(values).max(axis=0)
    bad = most > BEYOND_MOST * limits.torque
    if not bad.any():
        return
    told = [
        f"{joint.name} {most[i]:.4g}, its motor makes {limits.torque[i]:.4g} "
        f"{'N' if joint.prismatic else 'N m'}"
        for i, joint in enumerate(arm.joints)
        if bad[i]
    ]
    raise InputError(
        f"{name}: up to {'; '.join(told)}: {_torque_proposal(name, most, limits, values, q, arm)}"
    )


def _torque_proposal(
    name: str, most: Floats, limits: Limits, values: Floats, q: Floats, arm: Arm
) -> str:
    """Thousandths of the rated torque, or mN m: what lies nearer to the weights' need."""
    needed = arm.robot.dynamics.gravity_torque(q)
    ratios: list[tuple[int, float]] = []
    scales: dict[str, list[float]] = {"thousandths of the rated torque": [], "mN m": []}
    for i, joint in enumerate(arm.joints):
        rated = float(joint.motor_values.get(joint.key("rated_torque_Nm"), limits.torque[i]))
        scales["thousandths of the rated torque"].append(1e-3 * rated)
        scales["mN m"].append(1e-3)
        ratio, alike = _ratio(values[:, i], needed[:, i])
        if abs(alike) > ALIKE:
            ratios.append((i, abs(ratio)))
    fitting = {
        unit: np.array(scale)
        for unit, scale in scales.items()
        if np.all(most * scale < BEYOND_MOST * limits.torque)
    }
    if not fitting:
        return "no usual unit would fit; `scale:` of the table turns them into N m"

    def misfit(unit: str) -> float:
        return float(sum(abs(np.log(fitting[unit][i] / ratio)) for i, ratio in ratios))

    unit = min(fitting, key=misfit)
    scale = ", ".join(f"{value:.4g}" for value in fitting[unit])
    return f"{unit}? `scale: {{{name}: [{scale}]}}` in the table of the columns would fit"


def _doubts(name: str, values: Floats, q: Floats, arm: Arm) -> list[str]:
    """Torques that go with the weight, but have another size or sign."""
    needed = arm.robot.dynamics.gravity_torque(q)
    found = []
    for i, joint in enumerate(arm.joints):
        ratio, alike = _ratio(values[:, i], needed[:, i])
        if abs(alike) < ALIKE or 1.0 / FACTOR < ratio < FACTOR:
            continue
        why = "does it count the other way?" if ratio < 0.0 else "is the unit N m at the joint?"
        found.append(
            f"{joint.name}: {name} times {ratio:.3g} would be what the URDF's weights need: {why} "
            f"(`scale: {{{name}: ...}}`)"
        )
    return found


def _ratio(measured: Floats, needed: Floats) -> tuple[float, float]:
    """What `measured` is to be multiplied by, and the correlation of the two about zero."""
    square = float(measured @ measured) * float(needed @ needed)
    if not square > 0.0:
        return 1.0, 0.0
    product = float(measured @ needed)
    return product / float(measured @ measured), product / float(np.sqrt(square))


def _proposal(key: str, bad: Flags, fits: Callable[[int, float], bool], arm: Arm) -> str:
    """A usual unit that all joints would fit in."""
    chosen = np.flatnonzero(bad).tolist()
    kinds = [SLIDING if arm.joints[i].prismatic else ROTARY for i in range(len(arm.joints))]
    for rotary, sliding in zip(ROTARY, SLIDING, strict=True):
        names = [sliding if kind is SLIDING else rotary for kind in kinds]
        scales = [kind[name] for kind, name in zip(kinds, names, strict=True)]
        if not all(fits(i, scales[i]) for i in chosen):
            continue
        unit = " and ".join(dict.fromkeys(names[i] for i in chosen))
        if len(set(scales)) == 1:
            return f"{unit}? `scale: {{{key}: {scales[0]:.6g}}}` in the table of the columns"
        mixed = ", ".join(f"{scales[i] if bad[i] else 1.0:.6g}" for i in range(len(scales)))
        return f"{unit}? `scale: {{{key}: [{mixed}]}}` in the table of the columns"
    return "no usual unit would fit"
