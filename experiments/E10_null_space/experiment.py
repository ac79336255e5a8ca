"""An elbow that gives way with its own spring, and a hand that does not notice."""

from typing import Any

import numpy as np

from limber.experiments.check import Check
from limber.experiments.context import Context
from limber.experiments.evaluate import case
from limber.experiments.inertia import joint_inertia
from limber.experiments.pictures import BLACK, BLUE, GREEN, ORANGE
from limber.experiments.truth import joints, motion, seconds, status
from limber.logs import Log
from limber.robot import load_robot

TITLE = "The elbow yields by its own spring; only the projector with the inertia spares the hand"
CLAIM = (
    "Seven joints leave the elbow free, and a spring in the null space holds it without the hand"
)
CLAIM += " noticing"
SECTION = "3"
PLANT = "ideal7 with its controller, driver and simulator, exact equations; cartesian_impedance"
FAST = False

ROBOT = "ideal7"
Q = np.array([0.0, 0.5, 0.0, -1.2, 0.0, 1.0, 0.0])
K = np.diag([1000.0] * 3 + [30.0] * 3)  # N/m, N m/rad
K_NULL = 10.0  # N m/rad, every joint
D_NULL = [3.0, 3.0, 3.0, 3.0, 0.5, 0.5, 0.1]  # N m s/rad; the hand's joints are light
LOAD = 0.1  # N m
PUSHED_AT, LETS_GO_AT, END = 3.0, 7.0, 9.0
PROJECTORS = {"dynamic": BLUE, "kinematic": ORANGE, "none": GREEN}


def run(context: Context) -> list[Check]:
    logs = {name: context.lab(scenario(name), name) for name in PROJECTORS}
    draw(context, logs)
    found = [Check("tip acceleration by a dynamically projected torque", 0.0,
                   leak(context), "m/s²", 1e-9, "absolute")]  # fmt: skip
    rests = {name: off_at_rest(log) for name, log in logs.items()}
    angle = LOAD / K_NULL * 1e3
    for name in ("dynamic", "kinematic"):
        title = f"elbow gives way, {name} projector"
        found.append(Check(title, angle, rests[name][0], "mrad", 0.03))
    name = "tip moved at 10 mrad of the elbow, dynamic projector"
    found.append(Check(name, 20.0, rests["dynamic"][1], "µm", 0.0, "at_most"))
    for name, formula in tip_moves().items():
        word = "no" if name == "none" else name
        title = f"tip moved at 10 mrad of the elbow, {word} projector"
        found.append(Check(title, formula, rests[name][1], "µm", 0.03))
    times = rests["kinematic"][1] / rests["dynamic"][1]
    found.append(Check("tip moved, kinematic over dynamic", 10.0, times, "", 0.0, "at_least"))
    return found


def null_vector() -> np.ndarray:
    """Unit vector z with J z = 0, elbow outwards."""
    z = np.linalg.svd(load_robot(ROBOT).chain.jacobian(Q))[2][-1]
    return z * np.sign(z[2])


def load() -> np.ndarray:
    """f M z / (zᵀM z): joint torque that accelerates the elbow alone, and does f on it."""
    M, z = joint_inertia(ROBOT, Q), null_vector()
    return LOAD * M @ z / (z @ M @ z)


def scenario(projector: str) -> dict[str, Any]:
    gains = {
        "law": "cartesian_impedance",
        "K_x_translation_N_per_m": float(K[0, 0]),
        "K_x_rotation_Nm_per_rad": float(K[3, 3]),
        "K_null_Nm_per_rad": K_NULL,
        "D_null_Nms_per_rad": D_NULL,
    }
    shape = {"ramp_s": 0.3, "for_s": LETS_GO_AT - PUSHED_AT}
    pushes = [
        {"link": f"link_{i + 1}", "torque_Nm": moment.tolist(), "id": i + 1, **shape}
        for i, moment in enumerate(moments(load()))
    ]
    return {
        "robot": ROBOT,
        "duration_s": END + 0.1,
        "integrator": "reference",
        "start_q": Q.tolist(),
        "timeline": [
            {"at_s": 0.3, "mode": "hold"},
            {"at_s": 0.8, "mode": "active"},
            {"at_s": 1.0, "gains": gains},
            # the gains have got there: without projector the damping we start with is too much
            {"at_s": 2.0, "gains": {"projector": projector}},
            *({"at_s": PUSHED_AT, "push": push} for push in pushes),
        ],
    }


def moments(torque: np.ndarray) -> np.ndarray:
    """Moments on the links, each about the axis of its joint, that add up to the joint torques."""
    axes = load_robot(ROBOT).chain.jacobian(Q)[3:].T
    return np.linalg.solve(np.triu(axes @ axes.T), torque)[:, None] * axes


def leak(context: Context) -> float:
    """Greatest entry of J M⁻¹ N, which turns a joint torque of 1 N m into tip acceleration."""
    zero = np.zeros(7)
    terms, answer = context.eval(
        [
            case("kin_dyn", ROBOT, q=Q, v=zero, W=np.zeros(6)),
            case(
                "nullspace",
                ROBOT,
                q=Q,
                v=zero,
                q_n=zero,
                Kn=K_NULL * np.eye(7),
                Dn=np.diag(D_NULL),
                projector="dynamic",
            ),
        ]
    )
    return float(np.abs(terms["J"] @ np.linalg.solve(terms["M"], answer["N"])).max())


def tip_moves() -> dict[str, float]:
    """µm. Kinematic: K e = (J⁺)ᵀ τ; none: e = J (JᵀK J + K_n)⁻¹ τ."""
    J, tau = load_robot(ROBOT).chain.jacobian(Q), load()
    kinematic = np.linalg.solve(K, np.linalg.pinv(J).T @ tau)
    none = J @ np.linalg.solve(J.T @ K @ J + K_NULL * np.eye(7), tau)
    return {
        "kinematic": float(np.linalg.norm(kinematic[:3])) * 1e6,
        "none": float(np.linalg.norm(none[:3])) * 1e6,
    }


def off(log: Log, start_s: float, end_s: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time, s; elbow along the null vector, mrad; how far the tip is from its goal, µm."""
    goal = status(log, start_s, end_s)["p_BD"][0]
    rows = motion(log, start_s, end_s)
    elbow = (joints(rows) - Q) @ null_vector() * 1e3
    return seconds(rows), elbow, np.linalg.norm(rows["p_BT"] - goal, axis=1) * 1e6


def off_at_rest(log: Log) -> tuple[float, float]:
    _, elbow, tip = off(log, LETS_GO_AT - 0.4, LETS_GO_AT - 0.31)
    return float(elbow.mean()), float(tip.mean())


def draw(context: Context, logs: dict[str, Log]) -> None:
    with context.picture(TITLE, columns=2, size=(12.5, 5.0)) as (left, right):
        formula = tip_moves()
        for name, color in PROJECTORS.items():
            t, elbow, tip = off(logs[name], PUSHED_AT - 0.5, END)
            t = t - PUSHED_AT
            label = {"dynamic": "with the inertia", "kinematic": "without the inertia",
                     "none": "no projector"}[name]  # fmt: skip
            left.plot(t, elbow, color=color, label=label)
            right.plot(t, tip, color=color, label=label)
            if name in formula:
                right.plot([1.5, 3.7], [formula[name]] * 2, color=BLACK, ls="--", lw=1.2, zorder=4)
        left.axhline(LOAD / K_NULL * 1e3, color=BLACK, ls="--", lw=1.2)
        left.annotate("load / stiffness of the null space", (5.9, 10), (0, 4), ha="right",
                      textcoords="offset points")  # fmt: skip
        left.set_title("Elbow, pushed along the null space")
        left.set_ylabel("elbow moved (mrad)")
        right.set_ylim(0, 700)
        right.set_title("Hand (dashed: formula)")
        right.set_ylabel("hand moved (µm)")
        for ax in (left, right):
            ax.set_xlabel("time since the push (s)")
        right.legend(loc="upper right")
