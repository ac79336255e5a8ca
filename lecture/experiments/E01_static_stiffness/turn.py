"""A closed turn of the hand against unequal rotational springs: does the spring give work away?

The moment goes around a rectangle: up about x, up about y, down about x, down about y. In the
other order the damper takes the same, but what the spring gives changes its sign: half of the
difference of the hand's work is the spring's alone, but for what lag adds. That goes with the
square of the speed, and two speeds tell it.
"""

from collections.abc import Callable

import numpy as np
from scipy.optimize import root
from scipy.spatial.transform import Rotation

from limber.model.rotations import cross, left_jacobian_inverse
from limber_lecture.context import Comparison, Context, near_zero
from limber_lecture.timeline import UNBOUNDED, in_turn
from limber_lecture.truth import motion, status

K_O = np.diag([10.0, 60.0, 30.0])  # N m/rad
SIDES = np.array([[9.0, 0.0, 0.0], [0.0, 45.0, 0.0]])  # N m
LEGS_S = (4.0, 8.0)  # how long a side takes: fast and slow
DAMPING_RATIO = 0.2
FIRST_AT, RESTS_S = 2.0, 3.5

Spring = Callable[[np.ndarray], np.ndarray]


def checks(works: dict[str, float]) -> list[Comparison]:
    """`works`: mode -> net_work()."""
    found = []
    for mode, work in works.items():
        name = f"work of a closed turn, {mode}"
        if mode in ("log", "quat"):
            found.append(near_zero(name, work * 1e3, "mJ", 1.0))
        else:
            found.append(Comparison(name, turn_work(mode), work, "J", 0.01))
    return found


def turn_work(mode: str) -> float:
    """∮ μ·ω along the orientations that balance the moment, in small steps. Trapezoids."""
    share = np.linspace(0.0, 1.0, 401)[:, None]
    x, y = SIDES
    legs = [share * x, x + share * y, (1 - share) * x + y, (1 - share) * y]
    moments = np.concatenate(legs)
    poses = [np.zeros(3)]
    for moment in moments[1:]:
        poses.append(_balance(SPRINGS[mode], moment, poses[-1]))
    R = Rotation.from_rotvec(poses)
    steps = (R[1:] * R[:-1].inv()).as_rotvec()
    return float(np.sum((moments[1:] + moments[:-1]) / 2 * steps))


def _balance(spring: Spring, moment: np.ndarray, start: np.ndarray) -> np.ndarray:
    return root(lambda r: spring(r) - moment, start).x


def _log(r: np.ndarray) -> np.ndarray:
    return left_jacobian_inverse(r).T @ K_O @ r


def _quat(r: np.ndarray) -> np.ndarray:
    *epsilon, eta = Rotation.from_rotvec(r).as_quat(canonical=True)
    return (eta * np.eye(3) - cross(np.array(epsilon))).T @ K_O @ (2 * np.array(epsilon))


def _quat_simple(r: np.ndarray) -> np.ndarray:
    return K_O @ (2 * Rotation.from_rotvec(r).as_quat(canonical=True)[:3])


# Moment of the spring turned by the rotation vector r
SPRINGS: dict[str, Spring] = {
    "log": _log,
    "quat": _quat,
    "log_simple": lambda r: K_O @ r,
    "quat_simple": _quat_simple,
}


def net_work(context: Context, start_q: list[float], mode: str) -> float:
    """That the spring takes from the hand in an infinitely slow turn, J."""
    fast, slow = (_half_difference(context, start_q, mode, leg_s) for leg_s in LEGS_S)
    return slow + (slow - fast) / ((LEGS_S[1] / LEGS_S[0]) ** 2 - 1)


def _half_difference(context: Context, start_q: list[float], mode: str, leg_s: float) -> float:
    """Two turns: about x first, then about y first."""
    turn_s = 4 * leg_s + RESTS_S
    starts = FIRST_AT, FIRST_AT + turn_s
    gains = {
        "law": "cartesian_impedance",
        "orientation": mode,
        "K_x_rotation_Nm_per_rad": np.diag(K_O),
        "damping_ratio": DAMPING_RATIO,
        **UNBOUNDED,
    }
    pushes = []
    for start, order in zip(starts, (SIDES, SIDES[::-1]), strict=True):
        sides = [{"torque_Nm": moment, "id": i + 1} for i, moment in enumerate(order)]
        pushes += in_turn(start, leg_s, sides, ramp_s=leg_s, for_s=3 * leg_s)
    name = f"turn_{mode}_{leg_s:g}s"
    end_s = starts[1] + turn_s
    log = context.run_law(name, "ideal7", gains, pushes, end_s, start_q=start_q)
    hand = []
    for start in starts:
        status(log, start, start + turn_s)
        rows = motion(log, start, start + turn_s)
        hand.append(rows["work_external_J"][-1] - rows["work_external_J"][0])
    return float(hand[0] - hand[1]) / 2
