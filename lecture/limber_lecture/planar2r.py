"""Closed forms of the reference arm robots/planar2r, for predictions.

Two uniform rods in the x-y plane, joints about z; q is (shoulder, elbow). Functions take complex q
too, so that derivatives can be had by a complex step.
"""

from collections.abc import Callable

import numpy as np

from limber.arrays import Floats
from limber_lecture.evaluate import case

ROBOT = "planar2r"
LENGTHS = np.array([0.5, 0.4])  # m
MASSES = np.array([4.0, 2.5])  # kg
GRAVITY = 9.81  # m/s²


def tip(q: Floats) -> Floats:
    return elbow(q) + elbow_to_tip(q)


def elbow(q: Floats) -> Floats:
    found: Floats = LENGTHS[0] * np.array([np.cos(q[0]), np.sin(q[0])])
    return found


def elbow_to_tip(q: Floats) -> Floats:
    angle = q[0] + q[1]
    found: Floats = LENGTHS[1] * np.array([np.cos(angle), np.sin(angle)])
    return found


def across(p: Floats) -> Floats:
    """z × p: how p moves when it turns."""
    return np.array([-p[1], p[0]])


def jacobian(q: Floats) -> Floats:
    return np.column_stack([across(tip(q)), across(elbow_to_tip(q))])


def geometric(q: Floats, f: Floats) -> Floats:
    """Column k is (∂Jᵀ/∂q_k) f = K_G: -[[p·f, p₂·f], [p₂·f, p₂·f]]."""
    whole, outer = tip(q) @ f, elbow_to_tip(q) @ f
    return -np.array([[whole, outer], [outer, outer]])


def jacobian_rate(q: Floats, v: Floats) -> Floats:
    """J̇ along v; also ∂(J v)/∂q, because J is itself a derivative."""
    first, second = -tip(q), -elbow_to_tip(q)  # ∂J₁/∂q₁; ∂J₁/∂q₂ = ∂J₂/∂q₁ = ∂J₂/∂q₂
    return np.column_stack([first * v[0] + second * v[1], second * (v[0] + v[1])])


def inverse(p: Floats) -> Floats:
    """Joint angles with the elbow to the left (q₂ > 0) for a tip within reach."""
    l1, l2 = LENGTHS
    q2 = np.arccos((p @ p - l1**2 - l2**2) / (2 * l1 * l2))
    q1 = np.arctan2(p[1], p[0]) - np.arctan2(l2 * np.sin(q2), l1 + l2 * np.cos(q2))
    return np.array([q1, q2])


def inertia(q: Floats) -> Floats:
    """M(q) of rods with their centres of mass in the middle."""
    (l1, l2), (m1, m2) = LENGTHS, MASSES
    outer = m2 * l2**2 / 3
    coupling = m2 * l1 * l2 / 2 * np.cos(q[1])
    return np.array(
        [
            [m1 * l1**2 / 3 + m2 * l1**2 + outer + 2 * coupling, outer + coupling],
            [outer + coupling, outer],
        ]
    )


def coriolis(q: Floats, v: Floats) -> Floats:
    """C(q, v) v; the inertia depends on the elbow alone."""
    bend = MASSES[1] * LENGTHS[0] * LENGTHS[1] / 2 * np.sin(q[1])
    found: Floats = bend * np.array([-v[1] * (2 * v[0] + v[1]), v[0] ** 2])
    return found


def weight(q: Floats) -> Floats:
    """g(q): the torque that holds the arm, gravity along -y."""
    outer = MASSES[1] * elbow_to_tip(q)[0] / 2
    inner = (MASSES[0] / 2 + MASSES[1]) * elbow(q)[0]
    return GRAVITY * np.array([inner + outer, outer])


def derivative(function: Callable[[Floats], Floats], q: Floats) -> Floats:
    """∂function/∂q by complex step: exact to rounding. One column a joint."""
    step = 1e-30
    columns = [np.imag(function(q + 1j * step * axis)) / step for axis in np.eye(len(q))]
    return np.column_stack(columns)


def direct_law(q: Floats, v: Floats, p_d: Floats, K: Floats, D: Floats) -> dict:
    """A case for limber-eval: the torque -Jᵀ(K x̃ + D ẋ) of the Cartesian law on this arm."""
    law = {"Kx": K, "Dx": D, "bias": "none", "mode": "log", "F_ff": np.zeros(2)}
    return case("cartesian_impedance", ROBOT, q=q, v=v, p_d=p_d, **law)
