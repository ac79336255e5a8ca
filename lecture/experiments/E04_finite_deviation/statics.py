"""Force errors, incremental stiffness, work around a circle, and the load a form can carry."""

import numpy as np

from limber_lecture import planar2r as arm
from limber_lecture.context import Comparison, Context, near_zero
from limber_lecture.search import order

from .equilibria import Task, carried, closed_curve, rests
from .laws import ALONG, DIRECT, ORDERS, P_D, WITH_CURL, Form, K, asked, closed, force_at, name

PUSH_N = 0.05
FORMS = [*ORDERS, DIRECT]


def checks(context: Context) -> list[Comparison]:
    context.progress("force errors")
    found = error_orders(context)
    context.progress("incremental stiffness")
    found += incremental(context)
    context.progress("work around a circle")
    found += circle_work(context)
    context.progress("limit load")
    return [*found, *limit_load(context)]


def force_errors(context: Context, form: Form, away_m: np.ndarray) -> np.ndarray:
    """Relative error of the force at the tip, displaced along ALONG."""
    poses = [arm.inverse(P_D + away * ALONG) for away in away_m]
    torques = asked(context, [(form, q) for q in poses])
    forces = np.array([force_at(q, tau) for q, tau in zip(poses, torques, strict=True)])
    right = -away_m[:, None] * (K @ ALONG)
    return np.linalg.norm(forces - right, axis=1) / np.linalg.norm(right, axis=1)


def error_orders(context: Context) -> list[Comparison]:
    away = np.geomspace(0.002, 0.02, 6)
    found = []
    for form, predicted in ORDERS.items():
        measured = order(away, force_errors(context, form, away))
        title = f"order of the force error in the deviation, {name(form)}"
        found.append(Comparison(title, predicted, measured, "", 0.1, "absolute"))
    worst = force_errors(context, DIRECT, np.linspace(0.005, 0.15, 6)).max()
    found.append(near_zero("force error of the direct law", worst, "", 1e-9))
    small = np.array([0.005])
    for form, predicted in leading_errors(small[0]).items():
        title = f"force error at 5 mm, {name(form)}"
        found.append(Comparison(title, predicted, force_errors(context, form, small)[0], "", 0.1))
    return found


def leading_errors(away: float) -> dict[Form, float]:
    """From the first neglected term: ½K H[Δ,Δ] at the present pose, with (∂Jᵀ/∂q Δ) K J Δ more."""
    q = arm.inverse(P_D + away * ALONG)
    delta = q - arm.inverse(P_D)
    curved = arm.jacobian_rate(q, delta) @ delta
    J = arm.jacobian(q)
    half = -J.T @ K @ curved / 2
    more = -arm.geometric(q, K @ J @ delta) @ delta
    scale = np.linalg.norm(K @ ALONG) * away
    return {
        ("first", "current"): float(np.linalg.norm(force_at(q, half)) / scale),
        ("full", "current"): float(np.linalg.norm(force_at(q, half + more)) / scale),
    }


def incremental(context: Context) -> list[Comparison]:
    """At 10 cm: J⁻ᵀ(K_q - K_G)J⁻¹, K_q the tangent of the form, against ±0.05 N put on top."""
    q = arm.inverse(P_D + 0.1 * ALONG)
    inverse = np.linalg.inv(arm.jacobian(q))
    external = {form: -force_at(q, closed(form, q)) for form in FORMS}
    measured = felt_stiffness(context, external, q)
    found = []
    for form in FORMS:
        tangent = -arm.derivative(lambda x, form=form: closed(form, x), q)
        felt = inverse.T @ (tangent - arm.geometric(q, external[form])) @ inverse
        title = f"stiffness felt at 10 cm along the deviation, {name(form)}"
        along = float(ALONG @ felt @ ALONG), float(ALONG @ measured[form] @ ALONG)
        found.append(Comparison(title, *along, "N/m", 0.02))
    return found


def felt_stiffness(
    context: Context, external: dict[Form, np.ndarray], q: np.ndarray
) -> dict[Form, np.ndarray]:
    """Pushes the resting arm by a little along both axes, and solves for where it comes to rest."""
    pushes = PUSH_N * np.vstack([np.eye(2), -np.eye(2)])
    tasks = [Task(form, force + push, q) for form, force in external.items() for push in pushes]
    tips = np.array([arm.tip(pose) for pose in rests(context, tasks)]).reshape(-1, 4, 2)
    moved = (tips[:, :2] - tips[:, 2:]) / (2 * PUSH_N)
    return {form: np.linalg.inv(m.T) for form, m in zip(external, moved, strict=True)}


def circle_work(context: Context) -> list[Comparison]:
    """Work of the spring while the tip is led once around 4 cm, centred 6 cm from the target."""
    angles = np.linspace(0.0, 2 * np.pi, 120, endpoint=False)
    around = np.column_stack([np.cos(angles), np.sin(angles)])
    poses = [arm.inverse(P_D + 0.06 * ALONG + 0.04 * spoke) for spoke in around]
    steps = [
        np.linalg.solve(arm.jacobian(q), arm.across(0.04 * spoke))
        for q, spoke in zip(poses, around, strict=True)
    ]
    found = []
    for form in FORMS:
        torques = asked(context, [(form, q) for q in poses])
        work = float(np.sum(torques * steps)) * 2 * np.pi / len(angles)
        title = f"work of a turn, {name(form)}"
        if form in WITH_CURL:
            found.append(Comparison(title, enclosed_curl(form) * 1e3, work * 1e3, "mJ", 0.01))
        else:
            found.append(near_zero(title, work * 1e3, "mJ", 1e-3))
    return found


def enclosed_curl(form: Form) -> float:
    """The same work by Stokes: ∂τ₂/∂q₁ - ∂τ₁/∂q₂ over the disk, closed form, Gauss points."""
    nodes, weights = np.polynomial.legendre.leggauss(8)
    angles = np.linspace(0.0, 2 * np.pi, 24, endpoint=False)
    total = 0.0
    for radius, weight in zip(0.02 * (nodes + 1), 0.02 * weights, strict=True):
        for angle in angles:
            spoke = np.array([np.cos(angle), np.sin(angle)])
            q = arm.inverse(P_D + 0.06 * ALONG + radius * spoke)
            slope = arm.derivative(lambda x: closed(form, x), q)
            # an area in the plane is det J times the area in the joints
            curl = (slope[1, 0] - slope[0, 1]) / np.linalg.det(arm.jacobian(q))
            total += curl * radius * weight * 2 * np.pi / len(angles)
    return float(total)


def limit_load(context: Context) -> list[Comparison]:
    """Greatest force along the deviation that a form can still rest under."""
    form = ("full", "current")
    predicted = float(closed_curve(form, 0.15)[:, 1].max())
    measured = float(carried(context, form, 1.2 * predicted)[-1, 1])
    twice = 2 * predicted
    (pose,) = rests(context, [Task(DIRECT, twice * ALONG, arm.inverse(P_D + 0.1 * ALONG))])
    away = twice / K[0, 0], np.linalg.norm(arm.tip(pose) - P_D)
    return [
        Comparison("limit load of full at current", predicted, measured, "N", 0.05),
        Comparison("deviation of the direct law under twice that", *away, "m", 1e-6),
    ]
