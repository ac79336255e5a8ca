"""Poses at which an arm stood still in a recorded run, and the torques of its joints there."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from limber import messages
from limber.errors import InputError
from limber.identify.recording import STAND_S
from limber.log.reader import Log
from limber.model.dynamics import ArmDynamics

WINDOW_S = 0.25
STILL = 2e-3  # rad or m: no joint moves further than this in a window
APART = 0.05  # rad or m: closer poses are one


@dataclass(frozen=True)
class StaticPoses:
    """One row a pose: mean position, and mean torque less the gravity torque of the model.

    The torque is what the joint's torque sensor reads or, without one, what was applied. `off_m`:
    how far the tip is from its goal.
    """

    q: np.ndarray
    tau: np.ndarray
    off_m: np.ndarray


def static_poses(paths: list[Path], dynamics: ArmDynamics) -> StaticPoses:
    windows = [window for path in paths for window in _windows(path, dynamics.size)]
    if not windows:
        raise InputError(f"nowhere does the arm stand still for {WINDOW_S} s while it is held")
    groups: list[list[tuple[np.ndarray, np.ndarray, float]]] = []
    for window in windows:
        near = next((g for g in groups if np.abs(g[0][0] - window[0]).max() < APART), None)
        if near is None:
            groups.append([window])
        else:
            near.append(window)
    means = [[np.mean(values, axis=0) for values in zip(*g, strict=True)] for g in groups]
    q, tau, off_m = (np.array([mean[i] for mean in means]) for i in range(3))
    return StaticPoses(q, tau - dynamics.gravity_torque(q), off_m)


def _windows(path: Path, n: int) -> list[tuple[np.ndarray, np.ndarray, float]]:
    """(q, tau, off_m) of every window in which the arm is held and still, and was for a while: at
    first it may lie in a stand.
    """
    return [window for part in Log(path).each_run() for window in _of_run(part, n)]


def _of_run(log: Log, n: int) -> list[tuple[np.ndarray, np.ndarray, float]]:
    status, state = log.read("CONTROLLER_STATUS"), log.read("JOINT_STATE")
    _, of_status, of_state = np.intersect1d(status["state_seq"], state["seq"], return_indices=True)
    status, state = status[of_status], state[of_state]
    if not len(status):
        return []
    modes, flags = map(messages.message_class, ("controller_status_t", "joint_state_t"))
    held = np.isin(status["mode"], (modes.MODE_HOLD, modes.MODE_ACTIVE))
    time_ns = state["time_ns"]
    held &= time_ns > time_ns[np.argmax(held)] + STAND_S * 1e9
    sensor = state["joint_flags"][:, :n] & flags.JOINT_TORQUE_SENSOR != 0
    q, tau = state["q"][:, :n], np.where(sensor, state["tau"][:, :n], state["tau_applied"][:, :n])
    off_m = np.linalg.norm(status["p_BT"] - status["p_BD"], axis=1)
    slots = time_ns // int(WINDOW_S * 1e9)
    found = []
    for slot in np.unique(slots):
        inside = slots == slot
        if held[inside].all() and np.ptp(q[inside], axis=0).max() < STILL:
            found.append((*(x[inside].mean(axis=0) for x in (q, tau)), off_m[inside].mean()))
    return found
