"""Inverse dynamics of a serial arm, for many samples at once.

    tau = M(q) a + C(q, v) v + g(q)

by the recursive Newton-Euler algorithm (Luh, Walker, Paul, 1980) in base axes. Like `urdf.py`
independent of the C++ chain on purpose. Rotors are not part of it.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from limber.arrays import Floats
from limber.model.bodies import Body
from limber.model.rotations import turned_about
from limber.model.urdf import MOVING, Chain

STEP_RAD = 1e-5
PARAMETERS = 10  # of a rigid body
UPPER = np.triu_indices(3)


@dataclass(frozen=True)
class Frames:
    """Of the child link of each moving joint; first index the joint, second the sample."""

    R: Floats  # n x N x 3 x 3
    p: Floats  # n x N x 3, origins
    z: Floats  # n x N x 3, joint axes


class ArmDynamics:
    """`gravity`: acceleration in base axes, m/s²."""

    def __init__(self, chain: Chain, bodies: list[Body], gravity: Floats) -> None:
        self.chain, self.bodies = chain, bodies
        self.gravity = np.asarray(gravity, float)
        self._slides = [j.kind == "prismatic" for j in chain.joints if j.kind in MOVING]

    @cached_property
    def size(self) -> int:
        return len(self.bodies)

    def torque(self, q: Floats, v: Floats, a: Floats) -> Floats:
        """N x n from N x n: one row a sample."""
        frames = self.frames(q)
        F, N = self._wrenches(frames, v, a)
        return self._project(frames, F, N)

    def gravity_torque(self, q: Floats) -> Floats:
        zero = np.zeros_like(q)
        return self.torque(q, zero, zero)

    def gravity_rate(self, q: Floats, v: Floats) -> Floats:
        """(∂g/∂q) v, N x n, N m/s, by central differences."""
        step = STEP_RAD * v
        return (self.gravity_torque(q + step) - self.gravity_torque(q - step)) / (2 * STEP_RAD)

    def gravity_slope(self, q: Floats) -> Floats:
        """∂g/∂q of one posture, n x n, N m/rad."""
        return self.gravity_rate(np.tile(q, (len(q), 1)), np.eye(len(q))).T

    def inertia(self, q: Floats) -> Floats:
        """M(q) of one posture, n x n, kg m²: column i is what the acceleration e_i takes."""
        still, unit = np.tile(q, (len(q), 1)), np.eye(len(q))
        return (self.torque(still, 0.0 * unit, unit) - self.gravity_torque(still)).T

    def gravity_regressor(self, q: Floats) -> Floats:
        """N x n x 4n: gravity torque per [mass, mass times centre] of each body."""
        zero = np.zeros_like(q)
        Y = self.regressor(q, zero, zero).reshape(len(q), self.size, self.size, PARAMETERS)
        return Y[..., :4].reshape(len(q), self.size, 4 * self.size)

    def regressor(self, q: Floats, v: Floats, a: Floats) -> Floats:
        """N x n x 10n: torque(q, v, a) per `parameters()`, in which it is linear (Atkeson, An,
        Hollerbach, "Estimation of inertial parameters of manipulator loads and links", 1986).
        """
        frames, n = self.frames(q), self.size
        Y = np.zeros((len(q), n, n, PARAMETERS))
        for k, moved in enumerate(self._moved(frames, v, a)):
            F, N = _unit_wrenches(frames.R[k], *moved)
            for i in range(k + 1):
                z = frames.z[i]
                Y[:, i, k] = np.einsum("nx,npx->np", z, F)
                if not self._slides[i]:
                    arm = np.cross(z, frames.p[k] - frames.p[i])
                    Y[:, i, k] = np.einsum("nx,npx->np", z, N) + np.einsum("nx,npx->np", arm, F)
        return Y.reshape(len(q), n, n * PARAMETERS)

    def parameters(self) -> Floats:
        """10n, by body: mass, kg; mass times centre, kg m; xx, xy, xz, yy, yz, zz of the inertia
        about the origin of the joint's child link, in its axes, kg m².
        """
        return np.concatenate(
            [[body.mass, *body.moment, *body.inertia[UPPER]] for body in self.bodies]
        )

    def frames(self, q: Floats) -> Frames:
        R = np.tile(np.eye(3), (len(q), 1, 1))
        p, columns = np.zeros((len(q), 3)), iter(np.asarray(q, float).T)
        found: list[tuple[Floats, Floats, Floats]] = []
        for joint in self.chain.joints:
            p = p + R @ joint.X_PF[:3, 3]
            R = R @ joint.X_PF[:3, :3]
            if joint.kind not in MOVING:
                continue
            angle, z = next(columns), R @ joint.axis
            if joint.kind == "prismatic":
                p = p + angle[:, None] * z
            else:
                R = R @ turned_about(angle[:, None] * joint.axis)
            found.append((R, p, z))
        return Frames(*(np.array(part) for part in zip(*found, strict=True)))

    def _moved(
        self, frames: Frames, v: Floats, a: Floats
    ) -> Iterator[tuple[Floats, Floats, Floats]]:
        """Of each body, outwards from the base: acceleration of its origin less gravity, angular
        velocity and angular acceleration.
        """
        w, wd = np.zeros((2, len(v), 3))
        acceleration, before = np.tile(-self.gravity, (len(v), 1)), np.zeros((len(v), 3))
        for i in range(self.size):
            r, z = frames.p[i] - before, frames.z[i]
            zv, za = z * v[:, i : i + 1], z * a[:, i : i + 1]
            acceleration = acceleration + np.cross(wd, r) + np.cross(w, np.cross(w, r))
            if self._slides[i]:
                acceleration = acceleration + za + 2.0 * np.cross(w, zv)
            else:
                wd = wd + za + np.cross(w, zv)
                w = w + zv
            yield acceleration, w, wd
            before = frames.p[i]

    def _wrenches(self, frames: Frames, v: Floats, a: Floats) -> tuple[Floats, Floats]:
        """Force and moment about its origin that each body needs."""
        F, N = np.zeros((2, self.size, len(v), 3))
        for i, moved in enumerate(self._moved(frames, v, a)):
            F[i], N[i] = _body_wrench(self.bodies[i], frames.R[i], *moved)
        return F, N

    def _project(self, frames: Frames, F: Floats, N: Floats) -> Floats:
        """On the joint axes, inwards from the tip."""
        tau = np.zeros((F.shape[1], self.size))
        force, moment = np.zeros((2, F.shape[1], 3))
        beyond = frames.p[-1]
        for i in reversed(range(self.size)):
            moment = N[i] + moment + np.cross(beyond - frames.p[i], force)
            force = F[i] + force
            tau[:, i] = np.sum(frames.z[i] * (force if self._slides[i] else moment), axis=1)
            beyond = frames.p[i]
        return tau


def _body_wrench(
    body: Body, R: Floats, acceleration: Floats, w: Floats, wd: Floats
) -> tuple[Floats, Floats]:
    moment = R @ body.moment
    inertia = R @ body.inertia @ R.transpose(0, 2, 1)
    force = body.mass * acceleration + np.cross(wd, moment) + np.cross(w, np.cross(w, moment))
    spin = np.einsum("nij,nj->ni", inertia, w)
    turn = np.einsum("nij,nj->ni", inertia, wd)
    return force, np.cross(moment, acceleration) + turn + np.cross(w, spin)


def _unit_wrenches(R: Floats, acceleration: Floats, w: Floats, wd: Floats) -> tuple[Floats, Floats]:
    """N x 10 x 3: force and moment of a body per parameter."""
    F, N = np.zeros((2, len(w), PARAMETERS, 3))
    F[:, 0] = acceleration
    for axis in range(3):
        x = R[:, :, axis]
        F[:, 1 + axis] = np.cross(wd, x) + np.cross(w, np.cross(w, x))
        N[:, 1 + axis] = np.cross(x, acceleration)
    in_body, turn = (np.einsum("nji,nj->ni", R, x) for x in (w, wd))
    for k, (i, j) in enumerate(zip(*UPPER, strict=True)):
        unit = np.zeros((3, 3))
        unit[i, j] = unit[j, i] = 1.0
        needed = turn @ unit + np.cross(in_body, in_body @ unit)
        N[:, 4 + k] = np.einsum("nij,nj->ni", R, needed)
    return F, N
