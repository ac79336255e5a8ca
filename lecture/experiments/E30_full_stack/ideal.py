"""The linearised arm with exact sensors: pushed until it rests, and loaded and unloaded."""

import numpy as np

from limber_lecture.elastic import Drives, run

from .arm import COULOMB_NM, KAPPA, Pose

PUSH_N = 27.0


def stiffness(pose: Pose) -> np.ndarray:
    """Along x, y, z: inverse of what the tip moves by a force."""
    columns = []
    for axis in np.eye(6)[:3]:
        tau = pose.J.T @ axis * PUSH_N
        drives = Drives(pose.rho, kappa=KAPPA)
        track = run(pose.plant(), pose.law(), 2.0, lambda t, tau=tau: tau, drives)
        columns.append((pose.J @ track.x.q[-1])[:3] / PUSH_N)
    return np.linalg.inv(np.column_stack(columns))


def load(t: np.ndarray | float, up_s: float) -> np.ndarray | float:
    """0 to 1, back to 0, and so on, with smooth edges as the simulator's pushes have."""
    return 0.5 - 0.5 * np.cos(np.pi * t / up_s)


def loop(pose: Pose, axis: np.ndarray, up_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Force and deflection of an unload and the load after it along `axis`, with friction."""
    tau = pose.J.T @ axis * PUSH_N
    drives = Drives(pose.rho, kappa=KAPPA, coulomb=COULOMB_NM)
    track = run(pose.plant(), pose.law(), 3 * up_s, lambda t: tau * load(t, up_s), drives)
    after = track.t >= up_s
    return PUSH_N * load(track.t[after], up_s), track.x.q[after] @ pose.J.T @ axis
