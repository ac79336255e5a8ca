"""What a URDF may have wrong, so that its errors are not taken for friction or a torque constant.

Torque is linear in mass, mass times centre and inertia of each body. Their likely errors enter each
fit as unknowns with a prior (Bayesian least squares), so that standard errors count them, too.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from limber.arrays import Floats
from limber.identify.arm import Arm
from limber.identify.motion import Motion
from limber.identify.motor_torque import sensed

MASS_SHARE = 0.3  # standard deviation of a mass of the URDF, unless weighed,
CENTRE_M = 0.05  # of a centre of mass, in proportion,
INERTIA_SHARE = 0.3  # of an inertia, also if weighed,
ROTOR_SHARE = 0.3  # and of a rotor's inertia
LEAST_NM = 1e-5  # rms of what counts


def prior_std(arm: Arm, share: float = MASS_SHARE) -> Floats:
    """Of dynamics.parameters(); `share`: how well masses are known."""
    bodies = arm.robot.dynamics.bodies
    return np.concatenate(
        [
            [body.mass * share]
            + 3 * [body.mass * CENTRE_M * share / MASS_SHARE]
            + 6 * [INERTIA_SHARE * np.trace(body.inertia) / 3.0]
            for body in bodies
        ]
    )


@dataclass(frozen=True)
class Loads:
    """Torque behind each gear, N x n: sensed where there is a sensor, else by the model; and by how
    much the latter may be wrong.
    """

    arm: Arm
    motion: Motion
    weights_share: float = MASS_SHARE

    @cached_property
    def model(self) -> Floats:
        motion = self.motion
        return self.arm.robot.dynamics.torque(motion.q, motion.v, motion.a)

    @cached_property
    def torque(self) -> Floats:
        return np.where(self.motion.torque_sensor, sensed(self.arm, self.motion), self.model)

    @cached_property
    def gravity(self) -> Floats:
        return self.arm.robot.dynamics.gravity_torque(self.motion.q)

    @cached_property
    def regressor(self) -> Floats:
        motion = self.motion
        return self.arm.robot.dynamics.regressor(motion.q, motion.v, motion.a)

    def errors(self, rows: Floats, i: int) -> Floats:
        """Likely errors of the torque at joint i as independent columns, each with a standard
        deviation of one: of the rotor and, without a torque sensor, of the links.
        """
        rotor = ROTOR_SHARE * self.arm.joints[i].rotor_inertia * self.motion.theta_ddot[rows, i]
        if self.motion.torque_sensor[i]:
            return independent(rotor[:, None])
        return independent(np.column_stack([rotor, self.errors_of_links(rows, i)]))

    def errors_of_links(self, rows: Floats, i: int) -> Floats:
        """The same of the model alone."""
        return independent(self.regressor[rows, i] * prior_std(self.arm, self.weights_share))


def independent(columns: Floats) -> Floats:
    """The same Gaussian process from as few columns as show it (principal components)."""
    values, vectors = np.linalg.eigh(columns.T @ columns / max(len(columns), 1))
    found: Floats = columns @ vectors[:, values > LEAST_NM**2]
    return found
