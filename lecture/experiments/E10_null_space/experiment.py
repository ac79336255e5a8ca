"""An elbow that gives way with its own spring, and a hand that does not notice."""

import numpy as np

from limber.model.robot import load_robot
from limber_lecture.context import Comparison, Context, at_least, at_most, case, near_zero
from limber_lecture.inertia import joint_inertia
from limber_lecture.pictures import BLACK, BLUE, GREEN, ORANGE, note
from limber_lecture.timeline import in_turn, tip_gains
from limber_lecture.truth import Log, joints, motion, status, time_s

TITLE = "The elbow yields by its own spring; only the projector with the inertia spares the hand"
CLAIM = "Seven joints leave the elbow free, and a spring in the null space holds it without the"
CLAIM += " hand noticing"
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


def run(context: Context) -> list[Comparison]:
    logs = {name: pushed(context, name) for name in PROJECTORS}
    draw(context, logs)
    rests = {name: off_at_rest(log) for name, log in logs.items()}
    angle, moved = LOAD / K_NULL * 1e3, "tip moved at 10 mrad of the elbow"
    times = rests["kinematic"][1] / rests["dynamic"][1]
    leaked = "tip acceleration by a dynamically projected torque"
    return [
        near_zero(leaked, leak(context), "m/s²", 1e-9),
        *(
            Comparison(f"elbow gives way, {name} projector", angle, rests[name][0], "mrad", 0.03)
            for name in ("dynamic", "kinematic")
        ),
        at_most(f"{moved}, dynamic projector", 20.0, rests["dynamic"][1], "µm"),
        *(
            Comparison(f"{moved}, {word} projector", tip_moves()[name], rests[name][1], "µm", 0.03)
            for name, word in (("kinematic", "kinematic"), ("none", "no"))
        ),
        at_least("tip moved, kinematic over dynamic", 10.0, times),
    ]


def null_vector() -> np.ndarray:
    """Unit vector z with J z = 0, elbow outwards."""
    z = np.linalg.svd(load_robot(ROBOT).chain.jacobian(Q))[2][-1]
    return z * np.sign(z[2])


def load() -> np.ndarray:
    """f M z / (zᵀM z): joint torque that accelerates the elbow alone, and does f on it."""
    M, z = joint_inertia(ROBOT, Q), null_vector()
    return LOAD * M @ z / (z @ M @ z)


def pushed(context: Context, projector: str) -> Log:
    gains = tip_gains(K[0, 0], K[3, 3], K_null_Nm_per_rad=K_NULL, D_null_Nms_per_rad=D_NULL)
    pushes = [
        {"link": f"link_{i + 1}", "torque_Nm": moment, "id": i + 1}
        for i, moment in enumerate(moments(load()))
    ]
    entries = [
        # the gains have got there: without projector the damping we start with is too much
        {"at_s": 2.0, "gains": {"projector": projector}},
        *in_turn(PUSHED_AT, 0.0, pushes, ramp_s=0.3, for_s=LETS_GO_AT - PUSHED_AT),
    ]
    return context.run_law(projector, ROBOT, gains, entries, END, start_q=Q)


def moments(torque: np.ndarray) -> np.ndarray:
    """Moments on the links, each about the axis of its joint, that add up to the joint torques."""
    axes = load_robot(ROBOT).chain.jacobian(Q)[3:].T
    return np.linalg.solve(np.triu(axes @ axes.T), torque)[:, None] * axes


def leak(context: Context) -> float:
    """Greatest entry of J M⁻¹ N, which turns a joint torque of 1 N m into tip acceleration."""
    zero = np.zeros(7)
    spring = {"q_n": zero, "Kn": K_NULL * np.eye(7), "Dn": np.diag(D_NULL)}
    terms, answer = context.eval(
        [
            case("kin_dyn", ROBOT, q=Q, v=zero, W=np.zeros(6)),
            case("nullspace", ROBOT, q=Q, v=zero, projector="dynamic", **spring),
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
    return time_s(rows), elbow, np.linalg.norm(rows["p_BT"] - goal, axis=1) * 1e6


def off_at_rest(log: Log) -> tuple[float, float]:
    _, elbow, tip = off(log, LETS_GO_AT - 0.4, LETS_GO_AT - 0.31)
    return float(elbow.mean()), float(tip.mean())


def draw(context: Context, logs: dict[str, Log]) -> None:
    with context.picture(TITLE, columns=2, size=(12.5, 5.0)) as (left, right):
        formula = tip_moves()
        for name, color in PROJECTORS.items():
            t, elbow, tip = off(logs[name], PUSHED_AT - 0.5, END)
            t = t - PUSHED_AT
            words = {"dynamic": "with the inertia", "kinematic": "without the inertia"}
            word = words.get(name, "no projector")
            left.plot(t, elbow, color=color, label=word)
            right.plot(t, tip, color=color, label=word)
            if name in formula:
                right.plot([1.5, 3.7], [formula[name]] * 2, color=BLACK, ls="--", lw=1.2, zorder=4)
        angle = LOAD / K_NULL * 1e3
        left.axhline(angle, color=BLACK, ls="--", lw=1.2)
        note(left, "load / stiffness of the null space", (5.9, angle), (0, 4), ha="right")
        left.set_title("Elbow, pushed along the null space")
        left.set_ylabel("elbow moved (mrad)")
        right.set_ylim(0, 700)
        right.set_title("Hand (dashed: formula)")
        right.set_ylabel("hand moved (µm)")
        for ax in (left, right):
            ax.set_xlabel("time since the push (s)")
        right.legend(loc="upper right")
