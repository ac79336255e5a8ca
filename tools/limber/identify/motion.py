"""What the joints did in recorded runs, smoothed, with speeds and accelerations.

Every channel passes the same zero-phase low-pass filter, so that what was linear between them stays
so; speeds and accelerations are differences of filtered positions. Only stretches without gaps in
which the drives were on count.
"""

from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from scipy.ndimage import maximum_filter1d, minimum_filter1d
from scipy.signal import butter, sosfiltfilt

from limber import messages
from limber.errors import InputError
from limber.identify.arm import Arm
from limber.log.reader import Log

CUTOFF_HZ = 10.0
SAMPLES_HZ = 50.0
STAND_S = 1.0  # from the drives being on until the arm rests on them alone
EDGE_S = 0.3  # at the end: there the filter has no future
LEAST_S = 2.0
OLDEST = 3  # cycles that a lost reply may be bridged
BLOCK_S = 0.5  # what is further apart than this counts as independent
SLOWEST = 0.02  # rad/s or m/s: below it friction is on its way from stick to slip
SETTLE_S = 0.1  # from rest until the filter has forgotten it


@dataclass(frozen=True)
class Motion:
    """One row a sample, one column a joint; SI at the joint.

    `motor` is the motor's torque as the drive believes it, from its command or, behind a torque
    loop, from its current; `tau` what the torque sensors read, zero without them.
    """

    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    theta: np.ndarray
    theta_dot: np.ndarray
    theta_ddot: np.ndarray
    preload: np.ndarray  # of two motors; theta is their equilibrium
    motor: np.ndarray
    tau: np.ndarray
    moving: np.ndarray  # bool: the motor turns, and has for a while
    block: np.ndarray  # one number a sample: which stretch of BLOCK_S
    torque_sensor: np.ndarray  # bool, one a joint
    link_encoder: np.ndarray


def read_motion(paths: list[Path], arm: Arm) -> Motion:
    """Throws InputError if there is no stretch to use."""
    stretches: list[Motion] = []
    for path in paths:
        for state in _stretches(Log(path)):
            first = 1 + int(stretches[-1].block[-1]) if stretches else 0
            stretches.append(_smooth(state, arm, first))
    if not stretches:
        raise InputError(
            f"the drives are never on for {LEAST_S:g} s without a gap: is this the log of a run?"
        )
    joined = {}
    for field in fields(Motion):
        parts = [getattr(stretch, field.name) for stretch in stretches]
        of_joints = field.name in ("torque_sensor", "link_encoder")
        joined[field.name] = np.all(parts, axis=0) if of_joints else np.concatenate(parts)
    return Motion(**joined)


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


def _smooth(state: np.ndarray, arm: Arm, first_block: int) -> Motion:
    n = len(arm.joints)
    if int(state["num_joints"][0]) != n:
        raise InputError(
            f"the log has {state['num_joints'][0]} joints, {arm.robot.name} has {n}: "
            "give the arm of the run with --robot"
        )
    rate = 1e9 / float(state["period_ns"][0])
    sos = butter(4, CUTOFF_HZ, fs=rate, output="sos")
    every = max(round(rate / SAMPLES_HZ), 1)
    keep = slice(int(STAND_S * rate), len(state) - int(EDGE_S * rate), every)

    def smooth(values: np.ndarray) -> np.ndarray:
        return sosfiltfilt(sos, np.asarray(values, float), axis=0)

    def speeds(values: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        position = smooth(values)
        speed = np.gradient(position, 1.0 / rate, axis=0)
        return position[keep], speed[keep], np.gradient(speed, 1.0 / rate, axis=0)[keep]

    q, v, a = speeds(state["q"][:, :n])
    theta, theta_dot, theta_ddot = speeds(state["theta"][:, :n])
    time_s = (state["time_ns"] - state["time_ns"][0])[keep] * 1e-9
    flags = messages.message_class("joint_state_t")
    bits = np.bitwise_and.reduce(state["joint_flags"][:, :n], axis=0)
    return Motion(
        q=q,
        v=v,
        a=a,
        theta=theta,
        theta_dot=theta_dot,
        theta_ddot=theta_ddot,
        preload=smooth(state["preload"][:, :n])[keep],
        motor=smooth(_motor_torque(state, arm))[keep],
        tau=smooth(state["tau"][:, :n])[keep],
        moving=_moving(theta_dot, rate / every),
        block=first_block + (time_s // BLOCK_S).astype(int),
        torque_sensor=bits & flags.JOINT_TORQUE_SENSOR != 0,
        link_encoder=bits & flags.JOINT_LINK_ENCODER != 0,
    )


def _motor_torque(state: np.ndarray, arm: Arm) -> np.ndarray:
    columns = [
        state["current_A"][:, i] * joint.torque_constant
        if joint.torque_loop
        else state["tau_applied"][:, i]
        for i, joint in enumerate(arm.joints)
    ]
    return np.stack(columns, axis=1)


def _moving(speed: np.ndarray, rate: float) -> np.ndarray:
    """Faster than SLOWEST the same way all the time from SETTLE_S before to SETTLE_S after."""
    size = 2 * int(np.ceil(SETTLE_S * rate)) + 1
    forward = minimum_filter1d(speed, size, axis=0) > SLOWEST
    return forward | (maximum_filter1d(speed, size, axis=0) < -SLOWEST)
