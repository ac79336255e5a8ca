"""The balance of torques at one motor, which torque constant and friction are both read from.

    tau_motor = (load + B theta'' + F_c sign(theta') + d theta') / kappa + offset

tau_motor is what the drive believes it makes, kappa = true / believed torque constant, load what
the joint's torque sensor reads, or without one what the model of a free arm needs at (q, v, a).
Over motions in both directions through the same places friction and load stand apart
(Swevers, Verdonck, De Schutter, "Dynamic model identification for industrial robots", 2007).
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize_scalar

from limber.identify.arm import Arm
from limber.identify.motion import Motion
from limber.identify.regression import Fit, PoorLogError, fit

LOAD, COULOMB, VISCOUS, OFFSET, STRIBECK, STRIBECK_SPEED = range(6)
SURE = 4.0  # standard errors
HIGHEST_STRIBECK = 0.3  # rad/s or m/s
LEAST_SLOW = 50  # samples below half the Stribeck speed: without them it is extrapolated
LESS = 0.98  # of what is unexplained without it


@dataclass(frozen=True)
class MotorSide:
    """Coefficients in the order of the constants above; rows are the samples that count."""

    fit: Fit
    load: np.ndarray  # with the rotor's inertia
    motor: np.ndarray
    speed: np.ndarray
    block: np.ndarray
    stribeck_speed: float | None = None  # None: not seen

    @property
    def kappa(self) -> float:
        return float(1.0 / self.fit.x[LOAD])

    def friction(self, speed: np.ndarray) -> np.ndarray:
        """In steady sliding, true N m."""
        x, sign = self.fit.x, np.sign(speed)
        believed = x[COULOMB] * sign + x[VISCOUS] * speed
        if self.stribeck_speed is not None:
            believed += x[STRIBECK] * sign * np.exp(-((speed / self.stribeck_speed) ** 2))
        return self.kappa * believed

    @property
    def kappa_std(self) -> float:
        return float(self.fit.std[LOAD] * self.kappa**2)


def loads(arm: Arm, motion: Motion) -> np.ndarray:
    """Torque behind each gear, N x n: sensed where there is a sensor, else by the model."""
    model = arm.robot.dynamics.torque(motion.q, motion.v, motion.a)
    return np.where(motion.torque_sensor, sensed(arm, motion), model)


def sensed(arm: Arm, motion: Motion) -> np.ndarray:
    """What springs and, as far as robot.yaml knows them, dampers pass on to the links, N x n.

    A torque sensor feels the spring; the damper beside it adds D_J (theta' - q').
    """
    damping = [
        joint.believed("transmission", joint.key("damping_Nms_per_rad")) or 0.0
        for joint in arm.joints
    ]
    return motion.tau + np.array(damping) * (motion.theta_dot - motion.v)


def balance(arm: Arm, motion: Motion, loads: np.ndarray, i: int, known: bool = False) -> MotorSide:
    """Of joint i. `known`: take the torque constant as it is believed. Raises PoorLogError."""
    joint, rows = arm.joints[i], motion.moving[:, i]
    if joint.two_motors:
        raise PoorLogError("two motors pull at this joint: only one motor's balance is read")
    if not rows.any():
        raise PoorLogError("it does not move")
    load = (loads[:, i] + joint.rotor_inertia * motion.theta_ddot[:, i])[rows]
    speed, motor, block = motion.theta_dot[rows, i], motion.motor[rows, i], motion.block[rows]
    if not speed.min() < 0.0 < speed.max():
        raise PoorLogError("it moves in one direction only")
    fitted = _fit(load, motor, [np.sign(speed), speed, np.ones_like(speed)], block, known)
    return _with_stribeck(MotorSide(fitted, load, motor, speed, block), known)


def _fit(
    load: np.ndarray,
    motor: np.ndarray,
    columns: list[np.ndarray],
    block: np.ndarray,
    known: bool,
) -> Fit:
    """`known`: as if kappa were 1, exactly."""
    others = np.stack(columns, axis=1)
    if not known:
        return fit(np.column_stack([load, others]), motor, block)
    rest = fit(others, motor - load, block)
    covariance = np.zeros((len(rest.x) + 1, len(rest.x) + 1))
    covariance[1:, 1:] = rest.covariance
    return Fit(np.concatenate([[1.0], rest.x]), covariance, rest.residual, rest.blocks)


def _with_stribeck(side: MotorSide, known: bool) -> MotorSide:
    """Adds (F_s - F_c) exp(-(theta'/v_s)²) sign(theta') if it is there beyond doubt.

    Steady sliding of the bristle model (Canudas de Wit, Olsson, Astrom, Lischinsky, "A new model
    for control of systems with friction", 1995). v_s by search: the other unknowns are linear.
    """
    slow = np.sort(np.abs(side.speed))
    lowest = 2.0 * slow[min(LEAST_SLOW, len(slow) - 1)]
    if not lowest < HIGHEST_STRIBECK:
        return side

    def unexplained(log_speed: float) -> float:
        try:
            return _stribeck_fit(side, float(np.exp(log_speed)), known).rms
        except PoorLogError:
            return np.inf

    bounds = (np.log(lowest), np.log(HIGHEST_STRIBECK))
    speed = float(np.exp(minimize_scalar(unexplained, bounds=bounds, method="bounded").x))
    try:
        coarse = _stribeck_fit(side, speed, known)
        found = _stribeck_fit(side, speed, known, float(coarse.x[STRIBECK]))
    except PoorLogError:
        return side
    sure = found.x[STRIBECK] > SURE * found.std[STRIBECK] and found.std[STRIBECK_SPEED] < speed / 2
    if not sure or found.rms > LESS * side.fit.rms:
        return side
    return replace(side, fit=found, stribeck_speed=speed)


def _stribeck_fit(side: MotorSide, speed: float, known: bool, rise: float | None = None) -> Fit:
    """With `rise` the derivative by the speed is a column, too: its standard error comes out."""
    sign, bell = np.sign(side.speed), np.exp(-((side.speed / speed) ** 2))
    columns = [sign, side.speed, np.ones_like(sign), sign * bell]
    if rise is not None:
        columns.append(rise * sign * bell * 2.0 * side.speed**2 / speed**3)
    return _fit(side.load, side.motor, columns, side.block, known)
