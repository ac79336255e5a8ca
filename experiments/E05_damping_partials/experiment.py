"""What the derivatives of the damping torque are, and what happens to a law that mistakes one."""

import numpy as np
from scipy.linalg import eigh

from limber.experiments import planar2r as arm
from limber.experiments.check import Check
from limber.experiments.context import Context
from limber.experiments.evaluate import case
from limber.experiments.pictures import GREEN, MEASURED, ORANGE

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


def run(context: Context) -> list[Check]:
    by_v, by_q = measured_partials(context)
    J, rate = arm.jacobian(Q), arm.jacobian_rate(Q, V)
    third = arm.geometric(Q, D @ J @ V)
    difference = [
        ("damping matrix ∂τ/∂q̇ differs from JᵀDJ by", by_v - J.T @ D @ J, "N m s/rad"),
        (
            "∂τ/∂q differs from third term + JᵀD ∂(Jq̇)/∂q by",
            by_q - third - J.T @ D @ rate,
            "N m/rad",
        ),
    ]
    checks = [
        Check(name, 0.0, float(np.abs(off).max()), unit, 1e-5, "absolute")
        for name, off, unit in difference
    ]
    missing = float(np.abs(by_q - third).max())
    name = "∂τ/∂q without the term that Eq. 5 leaves out, off by"
    checks.append(Check(name, float(np.abs(J.T @ D @ rate).max()), missing, "N m/rad", 1e-5))
    checks += printed_law(context)
    draw(context)
    return checks


def measured_partials(context: Context) -> tuple[np.ndarray, np.ndarray]:
    """Central differences of the damping torque JᵀD J q̇ that the Cartesian law commands."""
    axes = np.vstack([np.eye(2), -np.eye(2)]) * STEP
    points = [(Q, V + axis) for axis in axes] + [(Q + axis, V) for axis in axes]
    answers = context.eval(
        [
            case(
                "cartesian_impedance",
                arm.ROBOT,
                q=q,
                v=v,
                p_d=arm.tip(Q),
                Kx=np.zeros((2, 2)),
                Dx=D,
                bias="none",
                mode="log",
                F_ff=[0.0, 0.0],
            )
            for q, v in points
        ]
    )
    tau = -np.array([answer["tau"] for answer in answers])
    return ((tau[0:2] - tau[2:4]) / (2 * STEP)).T, ((tau[4:6] - tau[6:8]) / (2 * STEP)).T


def printed(context: Context, speeds: np.ndarray, gain: float = 30.0, unit: float = 1.0):
    """K_v of Eq. 6, JᵀDJ + (∂Jᵀ/∂q) D ẋ, while the tip moves out at each of the speeds, m/s.

    It is Eq. 4 with D in the place of the stiffness and ẋ in the place of the deviation. `unit`: of
    time, as a part of a second: D becomes D/unit and ẋ becomes ẋ unit.
    """
    answers = context.eval(
        [
            case(
                "eq4",
                arm.ROBOT,
                q=Q,
                p_d=arm.tip(Q) - unit * speed * OUTWARD,
                Kx=gain / unit * np.eye(2),
                mode="log",
            )
            for speed in speeds
        ]
    )
    return [answer["first"] + answer["geometric_fixed_wrench"] for answer in answers]


def critical_speed() -> float:
    """Where JᵀJ - s G stops being positive definite, G = -K_G of a unit vector outward: 1/λ_max."""
    J = arm.jacobian(Q)
    return 1 / float(eigh(-arm.geometric(Q, OUTWARD), J.T @ J, eigvals_only=True)[-1])


def printed_law(context: Context) -> list[Check]:
    speed = critical_speed()
    checks = []
    for name, gain, unit in (
        ("", 30.0, 1.0),
        (", ten times the gain", 300.0, 1.0),
        (", the same in milliseconds", 30.0, 1e-3),
    ):
        found = loses_definiteness(context, speed / unit, gain, unit)
        checks.append(
            Check(f"speed at which Eq. 6 is no damping{name}", speed / unit, found, "m/s", 1e-3)
        )
    (K_v,) = printed(context, np.array([2 * speed]))
    q_dot = np.linalg.eigh(K_v)[1][:, 0]
    power = float(q_dot @ K_v @ q_dot)
    name = "power it takes out at twice that speed, for 1 rad/s"
    return [*checks, Check(name, 0.0, power, "W", 0.0, "at_most")]


def loses_definiteness(context: Context, about: float, gain: float, unit: float) -> float:
    """By a comb, then a finer one."""
    low, high = 0.2 * about, 5.0 * about
    for _ in range(4):
        speeds = np.linspace(low, high, 21)
        lowest = [np.linalg.eigvalsh(K)[0] for K in printed(context, speeds, gain, unit)]
        last = int(np.argmax(np.array(lowest) <= 0)) - 1
        low, high = speeds[last], speeds[last + 1]
    return (low + high) / 2


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
        ax.annotate("feeds energy in", (speeds[3], -6), color=ORANGE)
        ax.axvline(critical_speed(), color="0.5", ls=":", lw=1)
        ax.annotate(
            "predicted: 1/λ",
            (critical_speed(), 22),
            xytext=(6, 0),
            color="0.35",
            textcoords="offset points",
        )
        ax.set_ylim(bottom=-12)
        ax.set_xlabel("speed of the tip outward (m/s)")
        ax.set_ylabel("eigenvalues of the damping matrix (N m s/rad)")
        ax.legend(loc="upper right")
