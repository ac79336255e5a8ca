"""The balance of torques at one motor, which torque constant and friction are both read from.

    tau_motor = (load + B theta'' + F_c sign(theta') + d theta') / kappa + offset

tau_motor is what the drive believes it makes, kappa = true / believed torque constant, load what
the joint's torque sensor reads, or without one what the model of a free arm needs at (q, v, a);
the likely errors of that model are further unknowns (`doubt.py`).
Over motions in both directions through the same places friction and load stand apart
(Swevers, Verdonck, De Schutter, "Dynamic model identification for industrial robots", 2007).
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize_scalar

from limber.arrays import Floats, Integers
from limber.identify.doubt import Loads
from limber.identify.regression import Fit, PoorLogError, Unknowns, fit, held_out, unexplained

LOAD, COULOMB, VISCOUS, OFFSET, STRIBECK, STRIBECK_SPEED = range(6)
KAPPA_LOW, KAPPA_HIGH = 0.4, 2.5  # a drive that is further off is another drive
SURE = 4.0  # standard errors
HIGHEST_STRIBECK = 0.3  # rad/s or m/s
EDGE = 0.02  # of the range of Stribeck speeds, logarithmic: there nothing was found
STEP = 2e-3  # of that range: how fine the search is
LEAST_SLOW = 50  # samples below the Stribeck speed: without them it is extrapolated
LESS = 0.98  # of what is unexplained without it
RISE_SHARE = 0.3  # of Coulomb's: a likely rise towards breakaway where none is seen,
RISE_SPEED = 0.1  # and below how many rad/s or m/s


@dataclass(frozen=True)
class MotorSide:
    """Coefficients in the order of the constants above, then errors of the model; rows are the
    samples that count. `known`: kappa is taken as 1, exactly.
    """

    fit: Fit
    load: Floats  # with the rotor's inertia
    motor: Floats
    speed: Floats
    block: Integers
    errors: Floats
    known: bool
    stribeck_speed: float | None = None  # None: not seen

    @property
    def kappa(self) -> float:
        return float(1.0 / self.fit.x[LOAD])

    @property
    def kappa_std(self) -> float:
        return float(self.fit.std[LOAD] * self.kappa**2)

    def friction(self, speed: Floats) -> Floats:
        """In steady sliding, N m; true ones as far as kappa is."""
        x, sign = self.fit.x, np.sign(speed)
        believed = x[COULOMB] * sign + x[VISCOUS] * speed
        if self.stribeck_speed is not None:
            believed += x[STRIBECK] * sign * np.exp(-((speed / self.stribeck_speed) ** 2))
        friction: Floats = self.kappa * believed
        return friction

    def unseen(self, *laws: int, errors: bool = False) -> Floats:
        """What load, offset and these terms leave of the motor's torque, each sample by a fit to
        other parts of the recording. `errors`: with what was found to be wrong with the model.
        """
        A, y, unknowns = _problem(self, self.stribeck_speed)
        first = STRIBECK + (self.stribeck_speed is not None)
        terms = np.arange(A.shape[1]) + self.known
        shown = np.isin(terms, [LOAD, OFFSET, *laws]) & (terms < first)
        return held_out(A, y, self.block, unknowns, shown | (errors & (terms >= first)))


def balance(loads: Loads, i: int, known: bool = False) -> MotorSide:
    """Of joint i. `known`: take the torque constant as it is believed. Raises PoorLogError."""
    joint, motion = loads.arm.joints[i], loads.motion
    rows = motion.moving[:, i]
    if joint.two_motors:
        raise PoorLogError("two motors pull at this joint: only one motor's balance is read")
    if not motion.motor_known[i]:
        raise PoorLogError("the recording does not hold its motor's torque")
    if not rows.any():
        raise PoorLogError("it does not move")
    load = (loads.torque[:, i] + joint.rotor_inertia * motion.theta_ddot[:, i])[rows]
    speed = motion.theta_dot[rows, i]
    if not speed.min() < 0.0 < speed.max():
        raise PoorLogError("it moves in one direction only")
    nothing = Fit(np.zeros(0), np.zeros((0, 0)), np.zeros(0))
    side = MotorSide(
        nothing,
        load,
        motion.motor[rows, i],
        speed,
        motion.block[rows],
        loads.errors(rows, i),
        known,
    )
    return _with_stribeck(replace(side, fit=_fit(side, None)))


def _columns(side: MotorSide, speed: float | None, rise: float | None = None) -> Floats:
    """With `rise` the derivative by the Stribeck speed is a column, too: its standard error comes
    out.
    """
    sign = np.sign(side.speed)
    columns = [side.load, sign, side.speed, np.ones_like(sign)]
    if speed is not None:
        bell = sign * np.exp(-((side.speed / speed) ** 2))
        columns.append(bell)
        if rise is not None:
            columns.append(rise * bell * 2.0 * side.speed**2 / speed**3)
    return np.column_stack([*columns, side.errors])


def _problem(
    side: MotorSide, speed: float | None, rise: float | None = None
) -> tuple[Floats, Floats, Unknowns]:
    """A x = y and what is allowed: friction does not drive, errors of the model have priors."""
    A, y = _columns(side, speed, rise), side.motor
    found = Unknowns.free(A.shape[1])
    found.prior[A.shape[1] - side.errors.shape[1] :] = 1.0
    found.low[LOAD], found.high[LOAD] = 1.0 / KAPPA_HIGH, 1.0 / KAPPA_LOW
    found.low[[COULOMB, VISCOUS] + ([] if speed is None else [STRIBECK])] = 0.0
    if side.known:
        A, y = A[:, 1:], y - side.load
        found = Unknowns(found.prior[1:], found.low[1:], found.high[1:])
    return A, y, found


def _fit(side: MotorSide, speed: float | None, rise: float | None = None) -> Fit:
    A, y, unknowns = _problem(side, speed, rise)
    found = fit(A, y, side.block, unknowns)
    if not side.known:
        return found
    covariance = np.pad(found.covariance, ((1, 0), (1, 0)))
    return replace(found, x=np.concatenate([[1.0], found.x]), covariance=covariance)


def _with_stribeck(side: MotorSide) -> MotorSide:
    """Adds (F_s - F_c) exp(-(theta'/v_s)²) sign(theta') if it is there beyond doubt.

    Steady sliding of the bristle model (Canudas de Wit, Olsson, Astrom, Lischinsky, "A new model
    for control of systems with friction", 1995). v_s by search: the other unknowns are linear.
    """
    slow = np.sort(np.abs(side.speed))
    lowest = slow[min(LEAST_SLOW, len(slow) - 1)]
    if not lowest < HIGHEST_STRIBECK:
        return _with_doubt(side)

    def left(log_speed: float) -> float:
        A, y, unknowns = _problem(side, float(np.exp(log_speed)))
        try:
            return unexplained(A, y, side.block, unknowns)
        except PoorLogError:
            return np.inf

    low, high = np.log(lowest), np.log(HIGHEST_STRIBECK)
    xatol = STEP * (high - low)
    search = minimize_scalar(left, bounds=(low, high), method="bounded", options={"xatol": xatol})
    log_speed = float(search.x)
    if not EDGE < (log_speed - low) / (high - low) < 1.0 - EDGE:
        return _with_doubt(side)
    speed = float(np.exp(log_speed))
    try:
        coarse = _fit(side, speed)
        found = replace(side, fit=_fit(side, speed, float(coarse.x[STRIBECK])))
    except PoorLogError:
        return _with_doubt(side)
    found = replace(found, stribeck_speed=speed)
    rise, std = found.fit.x[STRIBECK], found.fit.std
    sure = rise > SURE * std[STRIBECK] and std[STRIBECK_SPEED] < speed / 2
    if not sure or not _smaller(found, side):
        return _with_doubt(side)
    return found


def _with_doubt(side: MotorSide) -> MotorSide:
    """A usual rise towards breakaway, where none shows, is one more thing that may be wrong."""
    rise = RISE_SHARE * side.fit.x[COULOMB] * np.sign(side.speed)
    bell = rise * np.exp(-((side.speed / RISE_SPEED) ** 2))
    doubted = replace(side, errors=np.column_stack([side.errors, bell]))
    return replace(doubted, fit=_fit(doubted, None))


def _smaller(found: MotorSide, side: MotorSide) -> bool:
    """Whether the Stribeck term makes held-out residuals smaller."""
    laws = (COULOMB, VISCOUS, STRIBECK)
    with_it, without = found.unseen(*laws, errors=True), side.unseen(*laws, errors=True)
    return float(np.std(with_it)) < LESS * float(np.std(without))
