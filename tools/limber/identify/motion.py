"""What the joints did in recordings, smoothed, with speeds and accelerations.

Every channel passes the same zero-phase low-pass filter, so that what was linear between them stays
so; speeds and accelerations are differences of filtered positions.
"""

from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from scipy.ndimage import maximum_filter1d, minimum_filter1d
from scipy.signal import butter, sosfiltfilt

from limber.identify.arm import Arm
from limber.identify.recording import Recording, read_logs

CUTOFF_HZ = 10.0
SAMPLES_HZ = 50.0
EDGE_S = 0.3  # at both ends: there the filter has no past or no future
BLOCK_S = 0.5
SLOWEST = 0.02  # rad/s or m/s: below it friction is on its way from stick to slip
OF_JOINTS = ("torque_sensor", "link_encoder", "motor_known")
SETTLE_S = 0.1  # from rest until the filter has forgotten it


@dataclass(frozen=True)
class Motion:
    """One row a sample, one column a joint; SI at the joint; `motor` and `tau` as in Recording."""

    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    theta: np.ndarray
    theta_dot: np.ndarray
    theta_ddot: np.ndarray
    preload: np.ndarray
    motor: np.ndarray
    tau: np.ndarray
    moving: np.ndarray  # bool: the motor turns, and has for a while
    block: np.ndarray  # one number a sample: which stretch of BLOCK_S
    torque_sensor: np.ndarray  # bool, one a joint
    link_encoder: np.ndarray
    motor_known: np.ndarray


def read_motion(paths: list[Path], arm: Arm) -> Motion:
    """Throws InputError if there is no stretch to use."""
    return motion_of(read_logs(paths, arm))


def motion_of(recordings: list[Recording]) -> Motion:
    stretches: list[Motion] = []
    for recording in recordings:
        first = 1 + int(stretches[-1].block[-1]) if stretches else 0
        stretches.append(_smooth(recording, first))
    joined = {}
    for field in fields(Motion):
        parts = [getattr(stretch, field.name) for stretch in stretches]
        of_joints = field.name in OF_JOINTS
        joined[field.name] = np.all(parts, axis=0) if of_joints else np.concatenate(parts)
    return Motion(**joined)


def _smooth(recording: Recording, first_block: int) -> Motion:
    rate = recording.rate_hz
    sos = butter(4, min(CUTOFF_HZ, rate / 5.0), fs=rate, output="sos")
    every = max(round(rate / SAMPLES_HZ), 1)
    start_s = max(recording.settled_s, EDGE_S)
    keep = slice(int(start_s * rate), len(recording.q) - int(EDGE_S * rate), every)

    def smooth(values: np.ndarray) -> np.ndarray:
        return sosfiltfilt(sos, np.asarray(values, float), axis=0)

    def speeds(values: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        position = smooth(values)
        speed = np.gradient(position, 1.0 / rate, axis=0)
        return position[keep], speed[keep], np.gradient(speed, 1.0 / rate, axis=0)[keep]

    q, v, a = speeds(recording.q)
    theta, theta_dot, theta_ddot = speeds(recording.theta)
    time_s = np.arange(len(recording.q))[keep] / rate
    return Motion(
        q=q,
        v=v,
        a=a,
        theta=theta,
        theta_dot=theta_dot,
        theta_ddot=theta_ddot,
        preload=smooth(recording.preload)[keep],
        motor=smooth(recording.motor)[keep],
        tau=smooth(recording.tau)[keep],
        moving=_moving(theta_dot, rate / every),
        block=first_block + (time_s // BLOCK_S).astype(int),
        torque_sensor=recording.torque_sensor,
        link_encoder=recording.link_encoder,
        motor_known=np.full(len(recording.torque_sensor), recording.motor_known),
    )


def _moving(speed: np.ndarray, rate: float) -> np.ndarray:
    """Faster than SLOWEST the same way all the time from SETTLE_S before to SETTLE_S after."""
    size = 2 * int(np.ceil(SETTLE_S * rate)) + 1
    forward = minimum_filter1d(speed, size, axis=0) > SLOWEST
    return forward | (maximum_filter1d(speed, size, axis=0) < -SLOWEST)
