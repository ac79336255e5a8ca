"""Seven elastic joints: how far a force moves the tip under a law on the motors, or on the link."""

from typing import Any

import numpy as np
from scipy.linalg import block_diag
from scipy.optimize import fsolve
from scipy.spatial.transform import Rotation

from limber.model.robot import load_robot
from limber.model.rotations import left_jacobian_inverse
from limber_lecture.context import Context
from limber_lecture.timeline import in_turn, tip_gains
from limber_lecture.truth import Log, motion, status
from limber_lecture.variants import variant

ROBOT = "ideal7"
HOME = np.array([0.0, 0.5, 0.0, -1.2, 0.0, 1.0, 0.0])
ROTOR = np.array([1.0, 1.0, 0.8, 0.8, 0.4, 0.3, 0.3])  # kg m²
SPRING = 1e3 * np.array([8.0, 8.0, 6.0, 6.0, 3.0, 3.0, 2.0])  # N m/rad
DAMPER = np.array([8.0, 8.0, 6.0, 6.0, 2.0, 2.0, 2.0])  # N m s/rad
RATIO = 4.0  # of the rotors' inertia to what the torque loops leave of it
K_X = np.diag([3000.0] * 3 + [150.0] * 3)
K_NULL = 10.0
FORCE_N = 27.0
ON_MOTOR, AT_REST = "motor", "static"
PUSH_S, EACH_S = 2.5, 2.0


def predicted(position: str) -> np.ndarray:
    """How far a force along each axis moves the tip along it, m: K_x⁻¹, and springs in series."""
    C = np.linalg.inv(K_X)
    if position == ON_MOTOR:
        J = load_robot(ROBOT).chain.jacobian(HOME)
        C = C + J @ np.diag(1 / SPRING) @ J.T
    return FORCE_N * np.diag(C)[:3]


def model(position: str) -> np.ndarray:
    """The same from the equilibrium of springs, law and force at their full size."""
    chain = load_robot(ROBOT).chain
    start = chain.forward(HOME)

    def spring_torque(q: np.ndarray) -> np.ndarray:
        X, J = chain.forward(q), chain.jacobian(q)
        turned = Rotation.from_matrix(X[:3, :3] @ start[:3, :3].T).as_rotvec()
        e = np.concatenate([X[:3, 3] - start[:3, 3], turned])
        A = block_diag(np.eye(3), left_jacobian_inverse(turned))
        null = np.eye(7) - np.linalg.pinv(J) @ J
        return -J.T @ A.T @ K_X @ e - K_NULL * null @ (q - HOME)

    def moved(force: np.ndarray) -> float:
        def unbalanced(x: np.ndarray) -> np.ndarray:
            """x: motors for the law on them; for the law at rest what it takes for the links."""
            u = spring_torque(x)
            q = x - u / SPRING if position == ON_MOTOR else x
            return u + chain.jacobian(q)[:3].T @ force

        x = fsolve(unbalanced, HOME, xtol=1e-12)
        q = x - spring_torque(x) / SPRING if position == ON_MOTOR else x
        return float((chain.forward(q)[:3, 3] - start[:3, 3]) @ force / FORCE_N)

    return np.array([moved(FORCE_N * axis) for axis in np.eye(3)])


def robot(context: Context) -> str:
    """ideal7 with elastic joints, sensors, and torque loops in CiA 402 drives; weightless."""
    motor = {
        "protocol": "cia402",
        "gear_ratio": 1,
        "rotor_torque_constant_Nm_per_A": 1,
        "phase_resistance_ohm": 0.1,
        "peak_torque_Nm": 300,
        "rated_torque_Nm": 10,
        "encoder_bits": 24,
    }
    motors: dict[str, Any] = {"ideal": None}
    joints: dict[str, Any] = {}
    for i in range(7):
        motors[f"motor_{i + 1}"] = {**motor, "rotor_inertia_kgm2": ROTOR[i]}
        spring = {"law": "linear", "stiffness_Nm_per_rad": SPRING[i]}
        joints[f"joint_{i + 1}"] = {
            "motor": f"motor_{i + 1}",
            "transmission": {"kind": "elastic", "spring": spring, "damping_Nms_per_rad": DAMPER[i]},
            "link_encoder": {"bits": 24},
            "torque_sensor": {"resolution_Nm": 0.01},
            "torque_loop": {"inertia_ratio": RATIO, "rate_hz": 4000},
        }
    changes = {"motors": motors, "joints": joints, "gravity_m_per_s2": np.zeros(3)}
    return variant(context.out / "arm", ROBOT, changes)


def measured(context: Context, position: str) -> np.ndarray:
    null = {"K_null_Nm_per_rad": K_NULL, "D_null_Nms_per_rad": 3.0}
    gains = tip_gains(K_X[0, 0], K_X[3, 3], damping_ratio=0.7, position_feedback=position, **null)
    forces = [{"force_N": FORCE_N * axis} for axis in np.eye(3)]
    pushes = in_turn(PUSH_S, EACH_S, forces, for_s=EACH_S, ramp_s=0.3)
    end, head = PUSH_S + 3 * EACH_S, {"integrator": "ode", "start_q": HOME}
    log = context.run_law(f"arm_{position}", robot(context), gains, pushes, end, **head)
    status(log, PUSH_S - 0.3, end)
    rest = _place(log, PUSH_S - 0.2, PUSH_S)
    ends = [PUSH_S + EACH_S * (i + 1) - 0.35 for i in range(3)]
    return np.array([(_place(log, t - 0.2, t) - rest)[i] for i, t in enumerate(ends)])


def _place(log: Log, start: float, end: float) -> np.ndarray:
    return motion(log, start, end)["p_BT"].mean(axis=0)
