"""Seven elastic joints: how far a force moves the tip under a law on the motors, or on the link."""

from typing import Any

import numpy as np
from scipy.optimize import fsolve
from scipy.spatial.transform import Rotation

from limber.experiments.context import Context
from limber.experiments.truth import motion, status
from limber.experiments.variants import variant
from limber.robot import load_robot

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
        turned = Rotation.from_matrix(X[:3, :3] @ start[:3, :3].T)
        e = np.concatenate([X[:3, 3] - start[:3, 3], turned.as_rotvec()])
        half = np.linalg.norm(e[3:]) / 2
        S = np.cross(np.eye(3), e[3:])  # [e]×
        A = np.eye(6)
        if half > 1e-6:
            A[3:, 3:] += -S / 2 + (1 - half / np.tan(half)) / (2 * half) ** 2 * S @ S
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
    motors: dict[str, Any] = {"ideal": None}
    joints: dict[str, Any] = {}
    for i in range(7):
        motors[f"motor_{i + 1}"] = {
            "protocol": "cia402",
            "gear_ratio": 1,
            "rotor_inertia_kgm2": float(ROTOR[i]),
            "rotor_torque_constant_Nm_per_A": 1,
            "phase_resistance_ohm": 0.1,
            "peak_torque_Nm": 300,
            "rated_torque_Nm": 10,
            "encoder_bits": 24,
        }
        spring = {"law": "linear", "stiffness_Nm_per_rad": float(SPRING[i])}
        joints[f"joint_{i + 1}"] = {
            "motor": f"motor_{i + 1}",
            "transmission": {
                "kind": "elastic",
                "spring": spring,
                "damping_Nms_per_rad": float(DAMPER[i]),
            },
            "link_encoder": {"bits": 24},
            "torque_sensor": {"resolution_Nm": 0.01},
            "torque_loop": {"inertia_ratio": RATIO, "rate_hz": 4000},
        }
    changes = {
        "motors": motors,
        "joints": joints,
        "gravity_m_per_s2": [0.0, 0.0, 0.0],
    }
    return variant(context.out / "arm", ROBOT, changes)


def measured(context: Context, position: str) -> np.ndarray:
    gains = {
        "law": "cartesian_impedance",
        "position": position,
        "K_x_translation_N_per_m": np.diag(K_X)[:3].tolist(),
        "K_x_rotation_Nm_per_rad": np.diag(K_X)[3:].tolist(),
        "damping_ratio": 0.7,
        "K_null_Nm_per_rad": K_NULL,
        "D_null_Nms_per_rad": 3.0,
    }
    pushes = [
        {
            "at_s": PUSH_S + EACH_S * i,
            "push": {"force_N": (FORCE_N * axis).tolist(), "for_s": EACH_S, "ramp_s": 0.3},
        }
        for i, axis in enumerate(np.eye(3))
    ]
    end = PUSH_S + 3 * EACH_S
    scenario = {
        "robot": robot(context),
        "start_q": HOME.tolist(),
        "duration_s": end + 0.05,
        "timeline": [
            {"at_s": 0.3, "mode": "hold"},
            {"at_s": 0.8, "mode": "active"},
            {"at_s": 1.0, "gains": gains},
            *pushes,
        ],
    }
    log = context.lab(scenario, f"arm_{position}")
    status(log, PUSH_S - 0.3, end)
    rest = _place(log, PUSH_S - 0.2, PUSH_S)
    ends = [PUSH_S + EACH_S * (i + 1) - 0.35 for i in range(3)]
    return np.array([(_place(log, t - 0.2, t) - rest)[i] for i, t in enumerate(ends)])


def _place(log: Any, start: float, end: float) -> np.ndarray:
    return motion(log, start, end)["p_BT"].mean(axis=0)
