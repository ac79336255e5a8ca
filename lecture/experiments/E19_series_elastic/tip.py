"""Two soft joints: the stiffness they give the tip, whatever tip stiffness is wanted."""

from typing import Any

import numpy as np
from numpy.linalg import eigvalsh
from scipy.optimize import fsolve

from limber.paths import robot_folder
from limber.yaml_file import read_yaml
from limber_lecture import planar2r as arm
from limber_lecture.context import Comparison, Context
from limber_lecture.pictures import BLUE, ORANGE, Axes, ellipse, name_axes
from limber_lecture.probing import Probing
from limber_lecture.variants import friction, variant

ROBOT = "antagonist2r"  # its links, with one motor a joint
SPRINGS = np.array([300.0, 150.0])  # N m/rad
DAMPERS = [8.0, 3.0]  # N m s/rad, so that a pushed arm comes to rest
ROTOR_KGM2 = 0.2  # behind the gear
HELD = {"K_q_Nm_per_rad": 2000.0, "D_q_Nms_per_rad": 28.0}  # by the drives, on the bus
SHOULDER = 0.3
ELBOWS = (1.2, 1.7, 2.2)
PROBING = Probing(first_at=2.0, each_s=2.0, axes=2, force=5.0)

Found = dict[float, dict[str, np.ndarray]]


def presented(elbow: float, held: float = np.inf) -> np.ndarray:
    """J⁻ᵀ K J⁻¹; motors that give way add to what the springs yield."""
    J = arm.jacobian(np.array([SHOULDER, elbow]))
    return np.linalg.inv(J @ np.diag(1 / SPRINGS + 1 / held) @ J.T)


def ideal(elbow: float) -> np.ndarray:
    """From equilibria of the springs under 0.1 N along each axis, J at the pose they give."""
    q0 = np.array([SHOULDER, elbow])

    def moved(force: np.ndarray) -> np.ndarray:
        q = fsolve(lambda q: SPRINGS * (q - q0) - arm.jacobian(q).T @ force, q0, xtol=1e-13)
        return arm.tip(q) - arm.tip(q0)

    pushes = 0.1 * np.eye(2)
    return np.linalg.inv(np.column_stack([(moved(f) - moved(-f)) / 0.2 for f in pushes]))


def bus(context: Context, elbow: float) -> np.ndarray:
    name = f"tip_{elbow:g}"
    robot, end = variant(context.out / name, ROBOT, sprung()), PROBING.end
    law = {"law": "joint_pd", "position_feedback": "motor", "joint_damping": "given", **HELD}
    start = [SHOULDER, elbow]
    log = context.run_law(name, robot, law, PROBING.timeline(), end, start_q=start)
    return PROBING.stiffness(log)


def sprung() -> dict[str, Any]:
    """A linear spring and one motor without friction at each joint; the arm lies."""
    joints = {}
    for joint, K, d in zip(("shoulder", "elbow"), SPRINGS, DAMPERS, strict=True):
        spring = {"law": "linear", "stiffness_Nm_per_rad": K, "k2_Nm_per_rad2": None}
        transmission = {"kind": "elastic", "spring": spring, "damping_Nms_per_rad": d}
        preload = {"preload_rad": None, "preload_max_rad": None}
        joints[joint] = {
            "transmission": {**transmission, **preload},
            "antagonist": None,
            "friction": friction(),
        }
    motor = read_yaml(robot_folder(ROBOT) / "robot.yaml")["motors"]["puller"]
    return {
        "gravity_m_per_s2": [0.0, 0.0, -9.81],
        "motors": {"puller": {"rotor_inertia_kgm2": ROTOR_KGM2 / motor["gear_ratio"] ** 2}},
        "joints": joints,
    }


def found(context: Context) -> Found:
    return {e: {"ideal": ideal(e), "bus": bus(context, e)} for e in ELBOWS}


def checks(seen: Found) -> list[Comparison]:
    made = []
    for elbow, ways in seen.items():
        for where, K in ways.items():
            held = np.inf if where == "ideal" else HELD["K_q_Nm_per_rad"]
            word = where if where == "ideal" else f"bus, motors held by {held:g} N m/rad"
            for i, axis in enumerate(("soft", "stiff")):
                asked, got = (eigvalsh((A + A.T) / 2)[i] for A in (presented(elbow, held), K))
                name = f"tip of two such joints, elbow at {elbow:g} rad, {word}: {axis} axis"
                made.append(Comparison(name, asked, got, "N/m", 0.01))
    return made


def draw(seen: Found, ax: Axes) -> None:
    for elbow, ways in seen.items():
        q = np.array([SHOULDER, elbow])
        links = np.array([[0, 0], arm.elbow(q), arm.tip(q)])
        ax.plot(*links.T, color="0.6", lw=2.5, solid_capstyle="round", zorder=1)
        formula = presented(elbow, HELD["K_q_Nm_per_rad"])
        for K, color, lw, ls in ((formula, BLUE, 1.6, "-"), (ways["bus"], ORANGE, 2.4, ":")):
            ax.plot(*(arm.tip(q)[:, None] + 1e-4 * ellipse(K)), ls, color=color, lw=lw, zorder=2)
    ax.plot([], [], color=BLUE, label="J⁻ᵀ K J⁻¹, motors in K")
    ax.plot([], [], ":", color=ORANGE, lw=2.4, label="felt on the arm")
    ax.set_aspect("equal")
    ax.margins(0.12)
    ax.set_title("Stiffness of the tip; 0.1 m is 1000 N/m")
    name_axes(ax, "x (m)", "y (m)", "lower right")
