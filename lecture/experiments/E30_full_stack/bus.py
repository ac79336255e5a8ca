"""The same arm behind seven CiA 402 drives with torque loops at 4 kHz; the law runs at 1 kHz."""

from typing import Any

import numpy as np

from limber.paths import robot_folder
from limber.yaml_file import read_yaml
from limber_lecture.context import Context
from limber_lecture.probing import Probing
from limber_lecture.timeline import UNBOUNDED, in_turn, tip_gains
from limber_lecture.truth import Log, joints, motion, status, time_s
from limber_lecture.variants import friction, variant

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
        motor["rotor_inertia_kgm2"] = B[i] / motor["gear_ratio"] ** 2
        motors[f"motor_{i + 1}"] = motor
        spring = {"stiffness_Nm_per_rad": K_J[i]}
        changed[name] = {
            "motor": f"motor_{i + 1}",
            "torque_rate_limit_Nm_per_s": 20_000,
            "transmission": {"spring": spring, "damping_Nms_per_rad": D_J[i]},
            "friction": friction(coulomb[i]),
            "link_friction": None,
            "torque_loop": {"inertia_ratio": rho, "rate_hz": 4000},
        }
    return {"motors": motors, "joints": changed}


def run(
    context: Context,
    name: str,
    rho: float,
    coulomb: np.ndarray,
    more: list,
    end_s: float,
    *,
    ratio: float = ZETA,
    kappa: float = KAPPA,
) -> Log:
    changes = flexible(rho, coulomb)
    weak = {
        motor: {"rotor_torque_constant_Nm_per_A": kappa * values["rotor_torque_constant_Nm_per_A"]}
        for motor, values in changes["motors"].items()
    }
    null = {"K_null_Nm_per_rad": K_NULL, "D_null_Nms_per_rad": D_NULL}
    law = {"position_feedback": "static", "damping_ratio": ratio, **null, **UNBOUNDED}
    gains = tip_gains(K_X[0, 0], K_X[3, 3], **law)
    robot = variant(context.out / name, ROBOT, changes)
    return context.run_law(name, robot, gains, more, end_s, plant_overrides={"motors": weak})


def stiffness(context: Context, rho: float) -> tuple[np.ndarray, np.ndarray]:
    """Pose at rest, and the stiffness a hand feels along x, y, z."""
    log = run(context, f"probed_{rho:g}", rho, 0 * COULOMB_NM, PROBED.timeline(), PROBED.end)
    rest = joints(motion(log, PROBED.first_at - 0.05, PROBED.first_at)).mean(axis=0)
    return rest, PROBED.stiffness(log)


def loop(
    context: Context, rho: float, axis: np.ndarray, up_s: float
) -> tuple[np.ndarray, np.ndarray]:
    """As ideal.loop."""
    pushes = [{"force_N": PUSH_N * axis[:3]}] * 2
    pushes = in_turn(FIRST_S, 2 * up_s, pushes, ramp_s=up_s, for_s=2 * up_s)
    end = FIRST_S + 3 * up_s
    log = run(context, f"loop_{rho:g}", rho, COULOMB_NM, pushes, end)
    status(log, FIRST_S, end)
    rows = motion(log, FIRST_S + up_s, end)
    t = time_s(rows) - FIRST_S
    start = motion(log, FIRST_S - 0.05, FIRST_S)["p_BT"].mean(axis=0)
    return PUSH_N * load(t, up_s), (rows["p_BT"] - start) @ axis[:3]
