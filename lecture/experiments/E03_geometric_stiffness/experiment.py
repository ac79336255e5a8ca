"""Under load, a joint stiffness feels as asked at the tip only with the second term of Eq. 4."""

from typing import Any

import numpy as np

from limber.model.robot import load_robot
from limber_lecture import planar2r as arm
from limber_lecture.context import Comparison, Context, near_zero
from limber_lecture.pictures import BLACK, BLUE, MEASURED, ORANGE, Axes, name_axes
from limber_lecture.probing import Probing
from limber_lecture.timeline import joint_damping, tip_gains

TITLE = "Under load, a joint stiffness gives the stiffness asked for only with the second term"
CLAIM = "The second term of Eq. 4 keeps the stiffness right where the arm is soft and loaded"
SECTION = "2"
PLANT = "planar2r and ideal7 with controller, driver and simulator, exact equations;"
PLANT += " law congruence_stiffness"
FAST = False

K = 200.0  # N/m
Q = np.radians([30.0, 90.0])
LOADED_AT, FIRST_AT = 1.2, 4.0  # s; the load, the first probe
LOADS = [0.0, 10.0, 20.0, 30.0, 40.0]  # N along x
ALL_TERMS = {"first": "without the second term", "geometric": "with the second term"}
COLORS = {"first": ORANGE, "geometric": BLUE}

# Seven joints hold 34 N that pull the tool down: the null space, which the law leaves free, then
# hangs in a stable position
K7, K7_TURN, LOAD7 = 400.0, 40.0, np.array([0.0, 0.0, -34.0])
Q7 = np.array([0.0, 0.5, 0.0, -1.2, 0.0, 1.0, 0.0])
D7 = [10.0, 10.0, 5.0, 5.0, 1.0, 1.0, 0.2]  # N m s/rad

Measured = dict[tuple[str, float], np.ndarray]


def run(context: Context) -> list[Comparison]:
    measured = {
        (terms, load): planar(context, terms, load) for terms in ALL_TERMS for load in LOADS
    }
    seven = {terms: seven_joints(context, terms) for terms in ALL_TERMS}
    with context.picture(TITLE, columns=3, size=(14.5, 5.0)) as (left, middle, right):
        draw_ellipses(left, measured)
        draw_loads(middle, measured)
        draw_seven(right, seven)
    return planar_checks(measured) + seven_checks(seven)


def planar(context: Context, terms: str, load: float) -> np.ndarray:
    gains = tip_gains(K, law="congruence_stiffness", stiffness_terms=terms)
    force = np.array([load, 0.0, 0.0])
    probing = Probing(FIRST_AT, each_s=2.4, axes=2)
    return under_load(context, f"{terms}_{load:.0f}N", arm.ROBOT, Q, force, gains, probing)


def seven_joints(context: Context, terms: str) -> np.ndarray:
    damping = joint_damping(D7)
    gains = tip_gains(K7, K7_TURN, "congruence_stiffness", stiffness_terms=terms, **damping)
    probing = Probing(FIRST_AT, each_s=8.0, axes=3)
    return under_load(context, f"{terms}_7", "ideal7", Q7, LOAD7, gains, probing)


def under_load(
    context: Context,
    name: str,
    robot: str,
    q: np.ndarray,
    force: np.ndarray,
    gains: dict[str, Any],
    probing: Probing,
) -> np.ndarray:
    """What the tip feels like, N/m, in a posture held under a force of the world on it."""
    held = {"joints_rad": q, "force_N": -force, "duration_s": 1.0}
    load = {"force_N": force, "ramp_s": 1.0, "for_s": probing.end + 0.1}
    entries = [{"at_s": LOADED_AT, "goal": held}, {"at_s": LOADED_AT, "push": load}]
    entries += probing.timeline()
    return probing.stiffness(context.run_law(name, robot, gains, entries, probing.end, start_q=q))


def felt(terms: str, load: float) -> np.ndarray:
    """J⁻ᵀ (K_q - K_G) J⁻¹."""
    J, K_G = arm.jacobian(Q), arm.geometric(Q, np.array([load, 0.0]))
    K_q = K * J.T @ J + (K_G if terms == "geometric" else 0.0)
    inverse = np.linalg.inv(J)
    return inverse.T @ (K_q - K_G) @ inverse


def planar_checks(measured: Measured) -> list[Comparison]:
    found = []
    for terms, title in ALL_TERMS.items():
        for load in LOADS[2::2]:
            predicted, got = felt(terms, load), measured[terms, load]
            scale = 0.02 * np.abs(predicted).max()
            for name, i, j in (("xx", 0, 0), ("yy", 1, 1), ("xy", 0, 1), ("yx", 1, 0)):
                text = f"stiffness {name} under {load:g} N, {title}"
                check = Comparison(text, predicted[i, j], got[i, j], "N/m", scale, "absolute")
                found.append(check)
    return found


def felt_seven(terms: str) -> np.ndarray:
    """Inverse of the force block of J (K_q - K_G)⁻¹ Jᵀ. With both terms K_q - K_G = Jᵀ K J, which
    is K⁻¹ at the tip; the null space then has no stiffness, and none is needed.
    """
    J = load_robot("ideal7").chain.jacobian(Q7)
    K_x = np.diag([K7] * 3 + [K7_TURN] * 3)
    K_G = geometric(J, LOAD7) if terms == "first" else np.zeros((7, 7))
    compliance = J @ np.linalg.pinv(J.T @ K_x @ J - K_G, rcond=1e-9) @ J.T
    return np.linalg.inv(compliance[:3, :3])


def geometric(J: np.ndarray, f: np.ndarray) -> np.ndarray:
    """(∂Jᵀ/∂q) f of revolute joints: (z_a × J_b)·f, a the nearer joint to the base."""
    n = J.shape[1]
    turned = np.cross(J[3:].T[:, None], J[:3].T[None, :]) @ f
    return np.array([[turned[min(i, k), max(i, k)] for k in range(n)] for i in range(n)])


def seven_checks(seven: dict[str, np.ndarray]) -> list[Comparison]:
    found = []
    for terms, title in ALL_TERMS.items():
        predicted, got = felt_seven(terms), seven[terms]
        for i, axis in enumerate("xyz"):
            text = f"seven joints under 34 N, stiffness along {axis}, {title}"
            found.append(Comparison(text, predicted[i, i], got[i, i], "N/m", 0.02))
        text = f"seven joints, all of the stiffness matrix, {title}, off by"
        found.append(near_zero(text, np.abs(got - predicted).max(), "N/m", 0.02 * K7))
    return found


def draw_ellipses(ax: Axes, measured: Measured) -> None:
    """Force that it takes to move the tip 1 cm, all directions, under the greatest load."""
    around = np.linspace(0.0, 2 * np.pi, 73)
    directions = 0.01 * np.vstack([np.cos(around), np.sin(around)])
    ax.plot(*(K * directions), color=BLACK, ls="--", lw=1.2)
    for terms in ALL_TERMS:
        ax.plot(*(felt(terms, LOADS[-1]) @ directions), color=COLORS[terms])
        dots = measured[terms, LOADS[-1]] @ directions[:, ::6]
        ax.plot(*dots, **MEASURED, color=COLORS[terms])
    ax.set_aspect("equal")
    ax.set_title(f"Force for 1 cm to each side, under {LOADS[-1]:.0f} N")
    name_axes(ax, "force along x (N)", "force along y (N)")


def draw_loads(ax: Axes, measured: Measured) -> None:
    loads = np.linspace(0.0, LOADS[-1], 41)
    ax.axhline(K, color=BLACK, ls="--", lw=1.2, label="asked for")
    for terms, title in ALL_TERMS.items():
        curves = [np.linalg.eigvalsh(felt(terms, load)) for load in loads]
        ax.plot(loads, curves, color=COLORS[terms], label=[title, None])
        dots = [np.linalg.eigvals(measured[terms, load]).real for load in LOADS]
        ax.plot(LOADS, dots, **MEASURED, color=COLORS[terms])
    ax.set_title("Softest and stiffest direction of two joints")
    ax.set_ylim(bottom=0)
    name_axes(ax, "load carried (N)", "stiffness felt (N/m)", "lower left")


def draw_seven(ax: Axes, seven: dict[str, np.ndarray]) -> None:
    ax.axhline(K7, color=BLACK, ls="--", lw=1.2)
    for shift, terms in zip((-0.17, 0.17), ALL_TERMS, strict=True):
        at = np.arange(3) + shift
        ax.bar(at, np.diag(felt_seven(terms)), 0.3, color=COLORS[terms], alpha=0.6)
        ax.plot(at, np.diag(seven[terms]), **MEASURED, color=BLACK)
    ax.set_xticks(range(3), ["x", "y", "z"])
    ax.set_title("Seven joints that hold 34 N up (circles: measured)")
    name_axes(ax, "direction", "stiffness felt (N/m)")
    ax.set_ylim(0, 520)
