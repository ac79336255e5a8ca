"""What the derivatives of the damping torque are, and what happens to a law that mistakes one."""

import numpy as np
from scipy.linalg import eigh

from limber_lecture import planar2r as arm
from limber_lecture.context import Comparison, Context, at_most, case, near_zero
from limber_lecture.pictures import GREEN, MEASURED, ORANGE, level, name_axes, note
from limber_lecture.search import limit_by_combs

TITLE = "The extra term of Eq. 6 is no damping: it feeds energy in when the tip moves out fast"
CLAIM = "The damping in joint coordinates is JᵀDJ (Eq. 3), and the derivative of the damping term"
CLAIM += " with respect to the joints adds to it (Eq. 6)"
SECTION = "2"
PLANT = "the controller's laws on planar2r"
FAST = True

Q = np.array([0.4, 1.1])
V = np.array([0.8, -0.6])
D = np.diag([30.0, 50.0])
STEP = 1e-5
OUTWARD = arm.tip(Q) / np.linalg.norm(arm.tip(Q))


def run(context: Context) -> list[Comparison]:
    by_v, by_q = measured_partials(context)
    J, rate = arm.jacobian(Q), arm.jacobian_rate(Q, V)
    third = arm.geometric(Q, D @ J @ V)
    eq6 = J.T @ D @ rate
    checks = [
        near_zero(f"{name} by", np.abs(off).max(), unit, 1e-5)
        for name, off, unit in (
            ("damping matrix ∂τ/∂q̇ differs from JᵀDJ", by_v - J.T @ D @ J, "N m s/rad"),
            ("∂τ/∂q differs from third term + JᵀD ∂(Jq̇)/∂q", by_q - third - eq6, "N m/rad"),
        )
    ]
    name = "∂τ/∂q without the term that Eq. 5 leaves out, off by"
    missing = np.abs(eq6).max(), np.abs(by_q - third).max()
    checks += [Comparison(name, *missing, "N m/rad", 1e-5), *printed_law(context)]
    draw(context)
    return checks


def measured_partials(context: Context) -> tuple[np.ndarray, np.ndarray]:
    """Central differences of the damping torque JᵀD J q̇ that the Cartesian law commands."""
    axes = np.vstack([np.eye(2), -np.eye(2)]) * STEP
    points = [(Q, V + axis) for axis in axes] + [(Q + axis, V) for axis in axes]
    cases = [arm.direct_law(q, v, arm.tip(Q), np.zeros((2, 2)), D) for q, v in points]
    tau = -np.array([answer["tau"] for answer in context.eval(cases)])
    return ((tau[0:2] - tau[2:4]) / (2 * STEP)).T, ((tau[4:6] - tau[6:8]) / (2 * STEP)).T


def printed(context: Context, speeds: np.ndarray, gain: float = 30.0, unit: float = 1.0):
    """K_v of Eq. 6, JᵀDJ + (∂Jᵀ/∂q) D ẋ, while the tip moves out at each of the speeds, m/s.

    It is Eq. 4 with D in the place of the stiffness and ẋ in the place of the deviation. `unit`: of
    time, as a part of a second: D becomes D/unit and ẋ becomes ẋ unit.
    """
    asked = [
        {"p_d": arm.tip(Q) - unit * speed * OUTWARD, "Kx": gain / unit * np.eye(2)}
        for speed in speeds
    ]
    answers = context.eval([case("eq4", arm.ROBOT, q=Q, mode="log", **wish) for wish in asked])
    return [answer["first"] + answer["geometric_fixed_wrench"] for answer in answers]


def critical_speed() -> float:
    """Where JᵀJ - s G stops being positive definite, G = -K_G of a unit vector outward: 1/λ_max."""
    J = arm.jacobian(Q)
    return 1 / float(eigh(-arm.geometric(Q, OUTWARD), J.T @ J, eigvals_only=True)[-1])


def printed_law(context: Context) -> list[Comparison]:
    speed = critical_speed()
    checks = []
    for name, gain, unit in (
        ("", 30.0, 1.0),
        (", ten times the gain", 300.0, 1.0),
        (", the same in milliseconds", 30.0, 1e-3),
    ):
        found = loses_definiteness(context, speed / unit, gain, unit)
        title = f"speed at which Eq. 6 is no damping{name}"
        checks.append(Comparison(title, speed / unit, found, "m/s", 1e-3))
    (K_v,) = printed(context, np.array([2 * speed]))
    q_dot = np.linalg.eigh(K_v)[1][:, 0]
    name = "power it takes out at twice that speed, for 1 rad/s"
    return [*checks, at_most(name, 0.0, q_dot @ K_v @ q_dot, "W")]


def loses_definiteness(context: Context, about: float, gain: float, unit: float) -> float:
    def damp(speeds: np.ndarray) -> list[bool]:
        return [np.linalg.eigvalsh(K)[0] > 0 for K in printed(context, speeds, gain, unit)]

    return limit_by_combs(damp, 0.2 * about, 5.0 * about, 21)


def draw(context: Context) -> None:
    speeds = np.linspace(-2.0, 4.0, 61) * critical_speed()
    J = arm.jacobian(Q)
    with context.picture(TITLE) as ax:
        right = np.linalg.eigvalsh(30 * J.T @ J)
        for value, name in ((right[0], "JᵀDJ, as Eq. 3"), (right[1], None)):
            ax.plot(speeds, np.full(len(speeds), value), color=GREEN, label=name)
        formula = [
            np.linalg.eigvalsh(30 * (J.T @ J + s * arm.geometric(Q, OUTWARD))) for s in speeds
        ]
        ax.plot(speeds, formula, color=ORANGE, label=["with the extra term, as Eq. 6", None])
        law = [np.linalg.eigvalsh(K) for K in printed(context, speeds[::6])]
        ax.plot(speeds[::6], law, **MEASURED, color=ORANGE, label=["the controller's terms", None])
        ax.axhspan(-12, 0, color=ORANGE, alpha=0.12, lw=0)
        note(ax, "feeds energy in", (speeds[3], -6), color=ORANGE)
        level(ax, "predicted: 1/λ", (critical_speed(), 22), (6, 0), upright=True)
        ax.set_ylim(bottom=-12)
        y_name = "eigenvalues of the damping matrix (N m s/rad)"
        name_axes(ax, "speed of the tip outward (m/s)", y_name, "upper right")
