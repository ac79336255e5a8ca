"""The same arm behind seven CiA 402 drives with torque loops at 4 kHz; the law runs at 1 kHz."""

from typing import Any

import numpy as np

from limber.experiments.context import Context
from limber.experiments.probing import Probing
from limber.experiments.truth import joints, motion, status
from limber.experiments.variants import variant
from limber.logs import Log
from limber.paths import robot_folder
from limber.robot import read_yaml

from .arm import COULOMB_NM, D_J, D_NULL, K_J, K_NULL, K_X, KAPPA, ROBOT, ZETA, B
from .ideal import PUSH_N, load

PROBED = Probing(first_at=3.0, each_s=1.2, axes=3, force=9.0)
FIRST_S = 2.5  # of load and unload


def flexible(rho: float, coulomb: np.ndarray) -> dict[str, Any]:
    """Robot with the reference set: every joint has a motor of its own, without lag."""
    content = read_yaml(robot_folder(ROBOT) / "robot.yaml")
    motors, changed = {}, {}
    for i, (name, joint) in enumerate(content["joints"].items()):
        motor = dict(content["motors"][joint["motor"]])
        motor.pop("actuator", None)
        motor["rotor_inertia_kgm2"] = float(B[i] / motor["gear_ratio"] ** 2)
        motors[f"motor_{i + 1}"] = motor
        changed[name] = {
            "motor": f"motor_{i + 1}",
            "torque_rate_limit_Nm_per_s": 20_000,
            "transmission": {
                "spring": {"stiffness_Nm_per_rad": float(K_J[i])},
                "damping_Nms_per_rad": float(D_J[i]),
            },
            "friction": {"coulomb_Nm": float(coulomb[i]), "viscous_Nms_per_rad": 0.0},
            "link_friction": None,
            "torque_loop": {"inertia_ratio": rho, "rate_hz": 4000},
        }
    return {"motors": motors, "joints": changed}


def run(
    context: Context, name: str, rho: float, coulomb: np.ndarray, more: list, end_s: float
) -> Log:
    changes = flexible(rho, coulomb)
    weak = {
        name: {"rotor_torque_constant_Nm_per_A": KAPPA * motor["rotor_torque_constant_Nm_per_A"]}
        for name, motor in changes["motors"].items()
    }
    gains = {
        "law": "cartesian_impedance",
        "position": "static",
        "K_x_translation_N_per_m": float(K_X[0, 0]),
        "K_x_rotation_Nm_per_rad": float(K_X[3, 3]),
        "damping_ratio": ZETA,
        "K_null_Nm_per_rad": K_NULL,
        "D_null_Nms_per_rad": D_NULL,
        "spring_force_N": 1000.0,
        "spring_moment_Nm": 1000.0,
    }
    scenario = {
        "robot": variant(context.out / name, ROBOT, changes),
        "reality": {"motors": weak},
        "integrator": "reference",
        "duration_s": end_s + 0.05,
        "timeline": [
            {"at_s": 0.3, "mode": "hold"},
            {"at_s": 0.8, "mode": "active"},
            {"at_s": 1.0, "gains": gains},
            *more,
        ],
    }
    return context.lab(scenario, name)


def stiffness(context: Context, rho: float) -> tuple[np.ndarray, np.ndarray]:
    """Pose at rest, and the stiffness a hand feels along x, y, z."""
    log = run(context, f"probed_{rho:g}", rho, 0 * COULOMB_NM, PROBED.timeline(), PROBED.end)
    rest = joints(motion(log, PROBED.first_at - 0.05, PROBED.first_at)).mean(axis=0)
    return rest, PROBED.stiffness(log)


def loop(
    context: Context, rho: float, axis: np.ndarray, up_s: float
) -> tuple[np.ndarray, np.ndarray]:
    """As ideal.loop."""
    force = (PUSH_N * axis[:3]).tolist()
    pushes = [
        {
            "at_s": FIRST_S + i * 2 * up_s,
            "push": {"force_N": [*force], "ramp_s": up_s, "for_s": 2 * up_s},
        }
        for i in range(2)
    ]
    end = FIRST_S + 3 * up_s
    log = run(context, f"loop_{rho:g}", rho, COULOMB_NM, pushes, end)
    status(log, FIRST_S, end)
    rows = motion(log, FIRST_S + up_s, end)
    t = rows["time_ns"] * 1e-9 - FIRST_S
    start = motion(log, FIRST_S - 0.05, FIRST_S)["p_BT"].mean(axis=0)
    return PUSH_N * load(t, up_s), (rows["p_BT"] - start) @ axis[:3]
