"""Apparent stiffness: displacement of the tip for each push of a scenario, beside the expected."""

from dataclasses import dataclass

import numpy as np

from limber.arrays import Floats, Records
from limber.log.reader import Log, time_s
from limber.measure import statics
from limber.measure.results import Result, close_to
from limber.measure.sound import sound
from limber.model import rotations
from limber.model.scenario import Push, Scenario

BEFORE_S = 0.2  # rest that is averaged before a push
PLATEAU_SHARE = 0.4  # the last part of a push's plateau, in which the arm is at rest again
DITHER_TOLERANCE = 0.1  # of what is asked: what a hand feels of an arm with dither
AXIS_NAMES = ("x", "y", "z", "rx", "ry", "rz")


@dataclass
class MeasuredPush:
    """One push. All is the difference of two rests: before the push, and at its end."""

    push: Push
    wrench: np.ndarray  # 6, N and N m, base axes
    displacement: np.ndarray  # 6, m and rad
    direction: np.ndarray  # 6, unit, of the push's force or torque
    C_expected: np.ndarray  # 6x6
    friction_bound: float  # most of the push that joint friction can hold at a rest, N or N m
    friction_took: float  # what it did hold, by the simulator's friction torques
    offset_after_m: float  # how far from where it was the tip came to rest after the release
    wished: float | None = None  # requested of springs, which come as near as they can
    friction_observed: bool = False  # then the bound is what friction behind the sensors holds
    dithered: bool = False  # then little of the bound is held in the end

    @property
    def span(self) -> tuple[float, float]:
        """Arm time it was measured in."""
        rests = _Rests.of(self.push)
        return rests.before[0], rests.during[1]

    @property
    def force(self) -> float:
        return float(self.wrench @ self.direction)

    @property
    def moved(self) -> float:
        """Along the push, m or rad."""
        return float(self.displacement @ self.direction)

    @property
    def stiffness(self) -> float:
        """What a hand feels: force over distance, N/m or N m/rad; infinite if nothing moved."""
        return self.force / self.moved if self.moved != 0.0 else float("inf")

    @property
    def stiffness_without_friction(self) -> float:
        """The law's part of it: what is left of the push, over distance."""
        left = self.force - self.friction_took
        return left / self.moved if self.moved != 0.0 else float("inf")

    @property
    def expected(self) -> float:
        return statics.stiffness_along(self.C_expected, self.direction)

    @property
    def felt_as_asked(self) -> bool:
        """Friction is made up for: a hand shall feel what was asked for."""
        return self.friction_bound == 0.0 or self.friction_observed or self.dithered

    @property
    def judged(self) -> float:
        """What is held against the expected: what a hand feels, or else the law's part of it."""
        return self.stiffness if self.felt_as_asked else self.stiffness_without_friction

    def allowed(self, tolerance: float) -> float:
        """How far that may be from the expected. What friction behind the sensors holds is not
        known, but for its bound, at the rest before the push and at the one during it.
        """
        if self.dithered:
            tolerance = max(tolerance, DITHER_TOLERANCE)
        hidden = 2.0 * self.friction_bound if self.friction_observed else 0.0
        left = abs(self.force) - hidden
        share = hidden / left if left > 0.0 else np.inf
        return self.expected * (tolerance + share)

    @property
    def angular(self) -> bool:
        return bool(np.any(self.direction[3:]))

    @property
    def axis(self) -> str:
        """Such as +x or -rz; the numbers if it is along none."""
        largest = int(np.argmax(np.abs(self.direction)))
        if abs(self.direction[largest]) > 1 - 1e-6:
            return "+-"[int(self.direction[largest] < 0)] + AXIS_NAMES[largest]
        part = self.direction[3:] if self.angular else self.direction[:3]
        return "(" + " ".join(f"{value:+.2f}" for value in part) + ")"


def measure_pushes(log: Log, scenario: Scenario) -> list[MeasuredPush]:
    """All pushes of the tip that the log covers and that a law resists with a stiffness."""
    truth, status = sound(log.read("SIM_TRUTH")), sound(log.read("CONTROLLER_STATUS"))
    if not len(truth):
        return []
    pushes = [push for push in scenario.pushes if not push.link]
    found = [_measure(truth, status, push, scenario) for push in pushes]
    return [measured for measured in found if measured is not None]


@dataclass(frozen=True)
class _Rests:
    """The two stretches of time a push is measured in."""

    before: tuple[float, float]
    during: tuple[float, float]

    @staticmethod
    def of(push: Push) -> "_Rests":
        plateau = push.duration_s - 2 * push.ramp_s
        end = push.at_s + push.duration_s - push.ramp_s
        return _Rests((push.at_s - BEFORE_S, push.at_s), (end - PLATEAU_SHARE * plateau, end))

    def mean(self, records: Records, field: str, when: str = "during") -> Floats:
        low, high = getattr(self, when)
        t = time_s(records)
        mean: Floats = records[field][(t >= low) & (t < high)].mean(axis=0)
        return mean

    def change(self, records: Records, field: str) -> Floats:
        change: Floats = self.mean(records, field) - self.mean(records, field, "before")
        return change

    def covered_by(self, records: np.ndarray) -> bool:
        t = time_s(records)
        inside = [((t >= low) & (t < high)).sum() >= 2 for low, high in (self.before, self.during)]
        return all(inside) and t[-1] >= self.during[1]


def _measure(
    truth: np.ndarray, status: np.ndarray, push: Push, scenario: Scenario
) -> MeasuredPush | None:
    rests = _Rests.of(push)
    if not rests.covered_by(truth):
        return None
    gains = scenario.gains_at(push.at_s)
    K_x = gains.in_base(_goal_axes(truth, status, rests))
    n = len(scenario.robot.joints)
    q = {when: rests.mean(truth, "q", when)[:n] for when in ("before", "during")}
    J = scenario.robot.chain.jacobian(q["during"])
    G = _response(scenario, push, q, K_x)
    direction = _direction(push.wrench)
    if G is None or not direction @ G @ J.T @ direction > 0:
        return None
    C = G @ J.T
    bound = took = 0.0
    if scenario.friction:
        joints, observed = scenario.robot.joints, gains.friction_observed
        held = np.array([j.link_friction if observed else j.friction for j in joints])
        held = scenario.friction_factor * held
        bound = statics.greatest_friction_force(G, C, direction, held)
    if scenario.friction and not gains.friction_observed:
        torque = rests.change(truth, "tau_friction")[:n]
        if len(status) and rests.covered_by(status):
            torque = torque + rests.change(status, "tau_null")[:n]
        took = -statics.force_of_torque(G, C, direction, torque)
    return MeasuredPush(
        push,
        rests.change(truth, "F_push"),
        _displacement(truth, rests),
        direction,
        C,
        bound,
        took,
        _offset_after(truth, rests, scenario),
        float(direction @ K_x @ direction) if gains.law == statics.SPRINGS else None,
        scenario.friction and gains.friction_observed,
        scenario.friction and gains.dithered,
    )


def _goal_axes(truth: np.ndarray, status: np.ndarray, rests: _Rests) -> np.ndarray:
    """R_BD while the arm is pushed; without the controller's word the tip's before the push."""
    told = len(status) and rests.covered_by(status)
    records, field, when = (status, "quat_BD", "during") if told else (truth, "quat_BT", "before")
    low, high = getattr(rests, when)
    t = time_s(records)
    quaternions = records[field][(t >= low) & (t < high)]
    if not np.linalg.norm(quaternions, axis=1).all():
        return np.eye(3)  # no pose is held
    return rotations.matrix_of(rotations.mean(quaternions))


def _response(
    scenario: Scenario, push: Push, q: dict[str, np.ndarray], K_x: np.ndarray
) -> np.ndarray | None:
    """G of the law at the push, 6xn; K_x in base axes. Springs are fitted where the arm was before
    it.
    """
    robot, gains = scenario.robot, scenario.gains_at(push.at_s)
    J = robot.chain.jacobian(q["during"])
    if gains.law != statics.SPRINGS:
        return statics.tip_response(gains.law, J, K_x, gains.K_q)
    pairs = [joint.pair for joint in robot.joints if joint.pair is not None]
    if scenario.friction or len(pairs) < len(robot.joints):
        return None  # what friction in the motors holds back is not predicted here
    weight = robot.dynamics.gravity_torque(q["before"][None])[0]
    sigma = statics.springs_fitted(robot.chain.jacobian(q["before"]), K_x, weight, pairs)
    return statics.springs_response(J, sigma, robot.dynamics.gravity_slope(q["during"]))


def _direction(wrench: np.ndarray) -> np.ndarray:
    """Unit vector of the force, or of the torque if there is no force."""
    direction = np.zeros(6)
    part = slice(0, 3) if np.any(wrench[:3]) else slice(3, 6)
    direction[part] = wrench[part] / np.linalg.norm(wrench[part])
    return direction


def _displacement(truth: np.ndarray, rests: _Rests) -> np.ndarray:
    means = {}
    t = time_s(truth)
    for when, (low, high) in (("before", rests.before), ("during", rests.during)):
        quaternions = truth["quat_BT"][(t >= low) & (t < high)]
        means[when] = rotations.mean(quaternions)
    turned = rotations.between(means["before"], means["during"])
    return np.concatenate([rests.change(truth, "p_BT"), turned])


def _offset_after(truth: np.ndarray, rests: _Rests, scenario: Scenario) -> float:
    """Distance from the rest before the push to the rest before whatever happens next."""
    t, end = time_s(truth), rests.during[1]
    following = min((at for at in scenario.event_times if at > end), default=t[-1])
    after = (t >= following - BEFORE_S) & (t < following) & (t > end + 2 * BEFORE_S)
    if not after.any():
        return float("nan")
    offset = truth["p_BT"][after].mean(axis=0) - rests.mean(truth, "p_BT", "before")
    return float(np.linalg.norm(offset))


def push_results(pushes: list[MeasuredPush], tolerance: float) -> list[Result]:
    """With friction a push feels stiffer than the law is; then the part of the law is judged."""
    results = []
    for measured in pushes:
        found = _results_of(measured, tolerance)
        for result in found:
            result.span = measured.span
        results += found
    return results


def _results_of(measured: MeasuredPush, tolerance: float) -> list[Result]:
    unit, force_unit = ("N m/rad", "N m") if measured.angular else ("N/m", "N")
    name = f"stiffness {measured.axis}"
    note = f"{measured.force:.3g} {force_unit} at {measured.push.at_s:g} s"
    if measured.wished is not None:
        note += f"; requested {measured.wished:.4g}, as near as the springs come"
    allowed = measured.allowed(tolerance)
    if measured.friction_observed:
        note += (
            f"; behind the sensors friction holds up to {measured.friction_bound:.2g} {force_unit}"
        )
    note += ", dither" * measured.dithered

    def row(name: str, value: float, note: str, judged: bool) -> Result:
        if not judged:
            return Result(name, value, unit, note=note)
        return close_to(name, value, unit, measured.expected, allowed, note)

    felt = row(name, measured.stiffness, note, measured.felt_as_asked)
    if measured.friction_bound == 0.0 or measured.friction_observed:
        return [felt]
    value = measured.stiffness_without_friction
    took = f"friction took {measured.friction_took:.2g} {force_unit}"
    law = row(f"{name} less friction", value, took, not measured.felt_as_asked)
    band_note = "without dither" if measured.dithered else "predicted, at a rest"
    bound = Result(
        f"friction band {measured.axis}", measured.friction_bound, force_unit, note=band_note
    )
    results = [felt, law, bound]
    offset_mm = measured.offset_after_m * 1e3
    if np.isfinite(offset_mm):
        offset = f"offset after {measured.axis}"
        results.append(Result(offset, offset_mm, "mm", note="kept by friction"))
    return results


def stiffness_matrix(pushes: list[MeasuredPush]) -> np.ndarray | None:
    """6x6 stiffness by least squares; None if the pushes do not span all six axes."""
    if len(pushes) < 6:
        return None
    F = np.column_stack([measured.wrench for measured in pushes])
    D = np.column_stack([measured.displacement for measured in pushes])
    scaled = F / np.abs(F).max(axis=1, keepdims=True, initial=1e-12)
    if np.linalg.matrix_rank(scaled, tol=1e-3) < 6:
        return None
    C = D @ np.linalg.pinv(F)
    return np.linalg.inv(C)


def matrix_results(pushes: list[MeasuredPush], tolerance: float, friction: bool) -> list[Result]:
    """The whole matrix against the expected one, both made unitless by the expected diagonal."""
    K = stiffness_matrix(pushes)
    if K is None or any(
        not np.allclose(p.C_expected, pushes[0].C_expected, rtol=0.2) for p in pushes
    ):
        return []
    K_expected = np.linalg.inv(pushes[0].C_expected)
    scale = 1.0 / np.sqrt(np.diag(K_expected))
    S = np.outer(scale, scale)
    off = float(np.linalg.norm((K - K_expected) * S) / np.linalg.norm(K_expected * S))
    result = Result("stiffness matrix, off by", off, note="6x6, relative")
    result.span = (min(p.span[0] for p in pushes), max(p.span[1] for p in pushes))
    if not friction:
        result.expected, result.tolerance, result.passed = 0.0, tolerance, bool(off <= tolerance)
    return [result]
