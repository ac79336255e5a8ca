"""Under load, a joint stiffness feels as asked at the tip only with the second term of Eq. 4."""

from typing import Any

import numpy as np

from limber.experiments import planar2r as arm
from limber.experiments.check import Check
from limber.experiments.context import Context
from limber.experiments.pictures import BLACK, BLUE, MEASURED, ORANGE
from limber.robot import load_robot

from .loaded import Loaded

TITLE = "Under load, a joint stiffness gives the stiffness asked for only with the second term"
CLAIM = "The second term of Eq. 4 keeps the stiffness right where the arm is soft and loaded"
SECTION = "2"
PLANT = "planar2r and ideal7 with controller, driver and simulator, exact equations; law eq4"
FAST = False

K = 200.0  # N/m
Q = np.radians([30.0, 90.0])
LOADS = [0.0, 10.0, 20.0, 30.0, 40.0]  # N along x
ALL_TERMS = {"first": "without the second term", "geometric": "with the second term"}
COLORS = {"first": ORANGE, "geometric": BLUE}

# Seven joints hold 34 N that pull the tool down: the null space, which the law leaves free, then
# hangs in a stable position
K7, K7_TURN, LOAD7 = 400.0, 40.0, np.array([0.0, 0.0, -34.0])
Q7 = np.array([0.0, 0.5, 0.0, -1.2, 0.0, 1.0, 0.0])
D7 = [10.0, 10.0, 5.0, 5.0, 1.0, 1.0, 0.2]  # N m s/rad

Measured = dict[tuple[str, float], np.ndarray]


def run(context: Context) -> list[Check]:
    measured = {
        (terms, load): planar_case(load).stiffness(context, terms, f"{terms}_{load:.0f}N")
        for terms in ALL_TERMS
        for load in LOADS
    }
    checks = planar_checks(measured)
    seven = {terms: seven_case().stiffness(context, terms, f"{terms}_7") for terms in ALL_TERMS}
    with context.picture(TITLE, columns=3, size=(14.5, 5.0)) as (left, middle, right):
        draw_ellipses(left, measured)
        draw_loads(middle, measured)
        draw_seven(right, seven)
    return checks + seven_checks(seven)


def planar_case(load: float) -> Loaded:
    gains = {"K_x_translation_N_per_m": K, "K_x_rotation_Nm_per_rad": 0.0}
    return Loaded("planar2r", Q, np.array([load, 0.0, 0.0]), gains, axes=2, settles_s=2.4)


def felt(terms: str, load: float) -> np.ndarray:
    """J⁻ᵀ (K_q - K_G) J⁻¹."""
    J, K_G = arm.jacobian(Q), arm.geometric(Q, np.array([load, 0.0]))
    K_q = K * J.T @ J + (K_G if terms == "geometric" else 0.0)
    inverse = np.linalg.inv(J)
    return inverse.T @ (K_q - K_G) @ inverse


def planar_checks(measured: Measured) -> list[Check]:
    found = []
    for terms, title in ALL_TERMS.items():
        for load in LOADS[2::2]:
            predicted, got = felt(terms, load), measured[terms, load]
            scale = 0.02 * np.abs(predicted).max()
            for name, i, j in (("xx", 0, 0), ("yy", 1, 1), ("xy", 0, 1), ("yx", 1, 0)):
                text = f"stiffness {name} under {load:g} N, {title}"
                values = float(predicted[i, j]), float(got[i, j])
                found.append(Check(text, *values, "N/m", scale, "absolute"))
    return found


def seven_case() -> Loaded:
    gains = {
        "K_x_translation_N_per_m": K7,
        "K_x_rotation_Nm_per_rad": K7_TURN,
        "joint_damping": "given",
        "D_q_Nms_per_rad": D7,
    }
    return Loaded("ideal7", Q7, LOAD7, gains, axes=3, settles_s=8.0)


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


def seven_checks(seven: dict[str, np.ndarray]) -> list[Check]:
    found = []
    for terms, title in ALL_TERMS.items():
        predicted, got = felt_seven(terms), seven[terms]
        for i, axis in enumerate("xyz"):
            text = f"seven joints under 34 N, stiffness along {axis}, {title}"
            found.append(Check(text, float(predicted[i, i]), float(got[i, i]), "N/m", 0.02))
        off = float(np.abs(got - predicted).max())
        text = f"seven joints, all of the stiffness matrix, {title}, off by"
        found.append(Check(text, 0.0, off, "N/m", 0.02 * K7, "absolute"))
    return found


def draw_ellipses(ax: Any, measured: Measured) -> None:
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
    ax.set_xlabel("force along x (N)")
    ax.set_ylabel("force along y (N)")


def draw_loads(ax: Any, measured: Measured) -> None:
    loads = np.linspace(0.0, LOADS[-1], 41)
    ax.axhline(K, color=BLACK, ls="--", lw=1.2, label="asked for")
    for terms, title in ALL_TERMS.items():
        curves = [np.linalg.eigvalsh(felt(terms, load)) for load in loads]
        ax.plot(loads, curves, color=COLORS[terms], label=[title, None])
        dots = [np.linalg.eigvals(measured[terms, load]).real for load in LOADS]
        ax.plot(LOADS, dots, **MEASURED, color=COLORS[terms])
    ax.set_title("Softest and stiffest direction of two joints")
    ax.set_xlabel("load carried (N)")
    ax.set_ylabel("stiffness felt (N/m)")
    ax.set_ylim(bottom=0)
    ax.legend(loc="lower left")


def draw_seven(ax: Any, seven: dict[str, np.ndarray]) -> None:
    ax.axhline(K7, color=BLACK, ls="--", lw=1.2)
    for shift, terms in zip((-0.17, 0.17), ALL_TERMS, strict=True):
        at = np.arange(3) + shift
        ax.bar(at, np.diag(felt_seven(terms)), 0.3, color=COLORS[terms], alpha=0.6)
        ax.plot(at, np.diag(seven[terms]), **MEASURED, color=BLACK)
    ax.set_xticks(range(3), ["x", "y", "z"])
    ax.set_xlabel("direction")
    ax.set_title("Seven joints that hold 34 N up (circles: measured)")
    ax.set_ylabel("stiffness felt (N/m)")
    ax.set_ylim(0, 520)
