"""Apparent stiffness: how far the tip went for each push of a scenario, against what was asked."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from limber import statics
from limber.charts import time_s
from limber.results import Result, close_to
from limber.scenario import Push, Scenario

BEFORE_S = 0.2  # rest that is averaged before a push
PLATEAU_SHARE = 0.4  # the last part of a push's plateau, in which the arm is at rest again
AXIS_NAMES = ("x", "y", "z", "rx", "ry", "rz")


@dataclass
class Measured:
    """One push. Displacement and wrench are differences against the rest before it."""

    push: Push
    law: str
    wrench: np.ndarray  # 6, N and N m, base axes
    displacement: np.ndarray  # 6, m and rad
    direction: np.ndarray  # 6, unit, of the push's force or torque
    C_asked: np.ndarray  # 6x6
    friction_force: float  # what Coulomb friction can take of the push, N or N m
    offset_after_m: float  # how far from where it was the tip came to rest after the release

    @property
    def force(self) -> float:
        return float(self.wrench @ self.direction)

    @property
    def stiffness(self) -> float:
        """N/m or N m/rad; infinite or negative if the tip did not give way."""
        moved = float(self.displacement @ self.direction)
        return self.force / moved if moved != 0.0 else float("inf")

    @property
    def asked(self) -> float:
        return statics.stiffness_along(self.C_asked, self.direction)

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


def measure_pushes(truth: np.ndarray, scenario: Scenario) -> list[Measured]:
    """All pushes of the tip that the log covers and that a law resists with a stiffness."""
    found = [_measure(truth, push, scenario) for push in scenario.pushes if not push.link]
    return [measured for measured in found if measured is not None]


def _measure(truth: np.ndarray, push: Push, scenario: Scenario) -> Measured | None:
    t = time_s(truth)
    start = push.at_s
    plateau = push.duration_s - 2 * push.ramp_s
    end = start + push.duration_s - push.ramp_s
    before = (t >= start - BEFORE_S) & (t < start)
    during = (t >= end - PLATEAU_SHARE * plateau) & (t < end)
    if before.sum() < 2 or during.sum() < 2 or t[-1] < end:
        return None
    gains = scenario.gains_at(start)
    J = scenario.robot.chain.jacobian(truth["q"][during].mean(axis=0))
    C = statics.tip_compliance(gains.law, J, gains.K_x, gains.K_q)
    direction = _direction(push.wrench)
    if C is None or not direction @ C @ direction > 0:
        return None
    held = np.array([joint.friction for joint in scenario.robot.joints])
    friction = statics.friction_force(J, held, direction) if scenario.friction else 0.0
    after = _rest_after(t, start + push.duration_s, scenario)
    rest = truth["p_BT"][before].mean(axis=0)
    offset = truth["p_BT"][after].mean(axis=0) - rest if after.any() else np.full(3, np.nan)
    return Measured(
        push,
        gains.law,
        truth["F_push"][during].mean(axis=0) - truth["F_push"][before].mean(axis=0),
        _displacement(truth, before, during),
        direction,
        C,
        friction,
        float(np.linalg.norm(offset)),
    )


def _direction(wrench: np.ndarray) -> np.ndarray:
    """Unit vector of the force, or of the torque if there is no force."""
    direction = np.zeros(6)
    part = slice(0, 3) if np.any(wrench[:3]) else slice(3, 6)
    direction[part] = wrench[part] / np.linalg.norm(wrench[part])
    return direction


def _displacement(truth: np.ndarray, before: np.ndarray, during: np.ndarray) -> np.ndarray:
    moved = truth["p_BT"][during].mean(axis=0) - truth["p_BT"][before].mean(axis=0)
    R_before = Rotation.from_quat(truth["quat_BT"][before], scalar_first=True).mean()
    R_during = Rotation.from_quat(truth["quat_BT"][during], scalar_first=True).mean()
    return np.concatenate([moved, (R_during * R_before.inv()).as_rotvec()])


def _rest_after(t: np.ndarray, end: float, scenario: Scenario) -> np.ndarray:
    """The last part of the time between a push's end and whatever happens next."""
    following = min((at for at in scenario.event_times if at > end - 1e-9), default=t[-1])
    return (t >= following - BEFORE_S) & (t < following) & (t > end + BEFORE_S)


def push_results(pushes: list[Measured], tolerance: float) -> list[Result]:
    results = []
    for measured in pushes:
        unit = "N m/rad" if measured.angular else "N/m"
        force_unit = "N m" if measured.angular else "N"
        share = tolerance + measured.friction_force / measured.force
        note = f"{measured.force:.3g} {force_unit} at {measured.push.at_s:g} s"
        if measured.friction_force:
            note += f"; friction may take {measured.friction_force:.2g} {force_unit}"
        result = close_to(
            f"stiffness {measured.axis}",
            measured.stiffness,
            unit,
            measured.asked,
            share * measured.asked,
            note,
        )
        # Judged as a balance of forces: friction adds to or takes from the push, not from the
        # stiffness.
        balance = measured.asked * float(measured.displacement @ measured.direction)
        result.passed = bool(abs(balance - measured.force) <= share * measured.force)
        results.append(result)
        if np.isfinite(measured.offset_after_m):
            offset_mm = measured.offset_after_m * 1e3
            name = f"offset after push {measured.axis}"
            note = "kept by friction" if measured.friction_force else ""
            results.append(Result(name, offset_mm, "mm", note=note))
    return results


def stiffness_matrix(pushes: list[Measured]) -> np.ndarray | None:
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


def matrix_results(pushes: list[Measured], tolerance: float, friction: bool) -> list[Result]:
    """The whole matrix against the asked one, both scaled by the asked diagonal: no units left."""
    K = stiffness_matrix(pushes)
    if K is None or any(not np.allclose(p.C_asked, pushes[0].C_asked, rtol=0.2) for p in pushes):
        return []
    K_asked = np.linalg.inv(pushes[0].C_asked)
    scale = 1.0 / np.sqrt(np.diag(K_asked))
    S = np.outer(scale, scale)
    off = float(np.linalg.norm((K - K_asked) * S) / np.linalg.norm(K_asked * S))
    result = Result("stiffness matrix, relative error", off, note="6x6, Frobenius norm")
    if not friction:
        result.asked, result.tolerance, result.passed = 0.0, tolerance, bool(off <= tolerance)
    return [result]
