"""The forms of Eq. 7 on the reference arm: asked of the controller, and in closed form.

A form is (which terms of Eq. 4, at which pose); DIRECT is the law -JᵀK x̃ they all stand for.
"""

import numpy as np

from limber_lecture import planar2r as arm
from limber_lecture.context import Context, case
from limber_lecture.pictures import BLACK, COLORS

Form = tuple[str, str]
DIRECT: Form = ("direct", "current")
ORDERS: dict[Form, int] = {
    ("first", "current"): 1,
    ("first", "desired"): 1,
    ("first", "mid"): 1,
    ("full", "current"): 1,
    ("full", "mid"): 2,
    ("full", "mean"): 2,
}
WITH_CURL: list[Form] = [("first", "current"), ("first", "mid")]
COLOR = dict(zip([*ORDERS, DIRECT], [*COLORS[:6], BLACK], strict=True))
Q_D = np.radians([20.0, 80.0])
P_D = arm.tip(Q_D)
K = 300.0 * np.eye(2)
ALONG = np.array([np.cos(0.7), np.sin(0.7)])


def name(form: Form) -> str:
    return "direct law" if form == DIRECT else f"{form[0]} at {form[1]}"


def asked(context: Context, pairs: list[tuple[Form, np.ndarray]]) -> np.ndarray:
    """Torques of the controller's laws, one row a pair of form and pose."""
    cases = []
    for form, q in pairs:
        if form == DIRECT:
            cases.append(arm.direct_law(q, np.zeros(2), P_D, K, np.eye(2)))
        else:
            spring = {"p_d": P_D, "q_d": Q_D, "Kx": K, "which": form[0], "pose": form[1]}
            damper = {"v": np.zeros(2), "v_d": np.zeros(2), "Dx": np.eye(2), "use_vd": False}
            cases.append(case("eq7", arm.ROBOT, q=q, **spring, **damper, bias="none"))
    return np.array([answer["tau"] for answer in context.eval(cases)])


def closed(form: Form, q: np.ndarray) -> np.ndarray:
    """The same in closed form; q may be complex."""
    if form == DIRECT:
        return -arm.jacobian(q).T @ K @ (arm.tip(q) - P_D)
    poses = {"current": [q], "desired": [Q_D], "mid": [(q + Q_D) / 2], "mean": [q, Q_D]}[form[1]]
    return -sum(stiffness(form[0], pose) for pose in poses) @ (q - Q_D) / len(poses)


def stiffness(which: str, q: np.ndarray) -> np.ndarray:
    J = arm.jacobian(q)
    first = J.T @ K @ J
    return first if which == "first" else first + arm.geometric(q, K @ (arm.tip(q) - P_D))


def force_at(q: np.ndarray, tau: np.ndarray) -> np.ndarray:
    """What the tip pushes with."""
    return np.linalg.solve(arm.jacobian(q).T, tau)
