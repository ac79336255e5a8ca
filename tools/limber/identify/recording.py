"""What was recorded of an arm, before anything is made of it: evenly sampled, without gaps."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from limber import messages
from limber.errors import InputError
from limber.identify.arm import Arm
from limber.log.reader import Log

LEAST_S = 2.0
STAND_S = 1.0  # from the drives being on until the arm rests on them alone
OLDEST = 3  # cycles that a lost reply may be bridged


@dataclass(frozen=True)
class Recording:
    """One stretch: one row a sample, one column a joint; SI at the joint.

    `motor` is the motor's torque as the drive believes it, from its command or, behind a torque
    loop, from its current; `tau` what the torque sensors read, zero without them. `settled_s`: at
    the start, until the arm rests on its motors alone.
    """

    rate_hz: float
    q: np.ndarray
    theta: np.ndarray
    preload: np.ndarray  # of two motors; theta is their equilibrium
    motor: np.ndarray
    tau: np.ndarray
    torque_sensor: np.ndarray  # bool, one a joint
    link_encoder: np.ndarray
    settled_s: float = 0.0
    motor_known: bool = True  # else `motor` is zero


def read_logs(paths: list[Path], arm: Arm, run: int | None = None) -> list[Recording]:
    """Only stretches in which the drives were on, of one run of each log or of all. Throws
    InputError if there is none.
    """
    parts = [part for path in paths for part in Log(path).each_run(run)]
    found = [_recording(state, arm) for part in parts for state in _stretches(part)]
    if not found:
        raise InputError(
            f"the drives are never on for {LEAST_S:g} s without a gap: is this the log of a run?"
        )
    return found


def _stretches(log: Log) -> list[np.ndarray]:
    state = log.read("JOINT_STATE")
    if not len(state):
        raise InputError(f"{log.path} holds no JOINT_STATE")
    flags = messages.message_class("joint_state_t")
    n = int(state["num_joints"].max())
    enabled = state["joint_flags"][:, :n] & flags.JOINT_ENABLED != 0
    fresh = state["age_cycles"][:, :n] <= OLDEST
    good = (state["drive_state"] == flags.DRIVE_ON) & np.all(enabled & fresh, axis=1)
    broken = (np.diff(state["seq"]) != 1) | (np.diff(good.astype(int)) != 0)
    parts = np.split(np.arange(len(state)), np.flatnonzero(broken) + 1)
    least = LEAST_S * 1e9 / max(int(state["period_ns"][0]), 1)
    return [state[part] for part in parts if good[part[0]] and len(part) >= least]


def _recording(state: np.ndarray, arm: Arm) -> Recording:
    n = len(arm.joints)
    if int(state["num_joints"][0]) != n:
        raise InputError(
            f"the log has {state['num_joints'][0]} joints, {arm.robot.name} has {n}: "
            "give the arm of the run with --robot, or one of several runs with --run"
        )
    flags = messages.message_class("joint_state_t")
    bits = np.bitwise_and.reduce(state["joint_flags"][:, :n], axis=0)
    return Recording(
        rate_hz=1e9 / float(state["period_ns"][0]),
        q=state["q"][:, :n],
        theta=state["theta"][:, :n],
        preload=state["preload"][:, :n],
        motor=_motor_torque(state, arm),
        tau=state["tau"][:, :n],
        torque_sensor=bits & flags.JOINT_TORQUE_SENSOR != 0,
        link_encoder=bits & flags.JOINT_LINK_ENCODER != 0,
        settled_s=STAND_S,
    )


def _motor_torque(state: np.ndarray, arm: Arm) -> np.ndarray:
    columns = [
        state["current_A"][:, i] * joint.torque_constant
        if joint.torque_loop
        else state["tau_applied"][:, i]
        for i, joint in enumerate(arm.joints)
    ]
    return np.stack(columns, axis=1)
