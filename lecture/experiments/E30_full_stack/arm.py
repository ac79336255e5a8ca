"""Seven flexible joints: the reference set, its equations near a pose, and the law for motors."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import eigh

from limber.model.robot import load_robot
from limber_lecture.elastic import ElasticArm, State
from limber_lecture.inertia import gravity_gradient, joint_inertia, tip_inertia

ROBOT = "panda"
B = np.array([1.0, 1.0, 0.8, 0.8, 0.4, 0.3, 0.3])  # kg m²
K_J = 1e3 * np.array([8.0, 8.0, 6.0, 6.0, 3.0, 3.0, 2.0])  # N m/rad
D_J = np.array([8.0, 8.0, 6.0, 6.0, 2.0, 2.0, 2.0])  # N m s/rad
COULOMB_NM = np.array([2.0, 2.0, 1.5, 1.5, 0.8, 0.8, 0.6])
K_X = np.diag([3000.0] * 3 + [150.0] * 3)  # N/m, N m/rad
K_NULL, D_NULL = 20.0, 5.0  # N m/rad, N m s/rad
ZETA = 0.7
KAPPA = 0.9  # true torque constant over the one assumed


def share(rho: float) -> float:
    """γ = κρ/(1 + κ(ρ - 1)): what a torque loop delivers of the torque asked for."""
    return KAPPA * rho / (1 + KAPPA * (rho - 1))


@dataclass(frozen=True)
class Pose:
    """The arm linearised where it rests, with a torque loop of ratio `rho`."""

    q: np.ndarray
    rho: float

    @cached_property
    def J(self) -> np.ndarray:
        return load_robot(ROBOT).chain.jacobian(self.q)

    @cached_property
    def G(self) -> np.ndarray:
        return gravity_gradient(ROBOT, self.q)

    @cached_property
    def M(self) -> np.ndarray:
        return joint_inertia(ROBOT, self.q)

    @cached_property
    def null(self) -> np.ndarray:
        """N = I - Jᵀ J̄ᵀ with the rotors as they seem."""
        M = self.M + np.diag(B / self.rho)
        return np.eye(7) - self.J.T @ tip_inertia(self.J, M) @ np.linalg.solve(M, self.J.T).T

    @cached_property
    def stiffness(self) -> np.ndarray:
        """-∂l/∂q of the static law l."""
        return self.J.T @ K_X @ self.J + K_NULL * self.null - self.G

    @cached_property
    def damping(self) -> np.ndarray:
        L = tip_inertia(self.J, self.M + np.diag(B / self.rho))
        k, modes = eigh(K_X, L)
        D_x = 2 * ZETA * L @ modes @ np.diag(np.sqrt(k)) @ modes.T @ L
        return self.J.T @ D_x @ self.J + D_NULL * self.null

    def plant(self) -> ElasticArm:
        return ElasticArm(self.M, B, K_J, D_J, self.G)

    def law(self) -> Callable[[float, State], np.ndarray]:
        """u = l(q̄) - D θ̇ with K_J (θ - q̄) = l(q̄)."""
        q_bar = np.linalg.solve(np.diag(K_J) - self.stiffness, np.diag(K_J))
        return lambda t, x: -self.stiffness @ q_bar @ x.theta - self.damping @ x.theta_dot

    def moved(self, wrench: np.ndarray) -> np.ndarray:
        """Tip under a wrench at rest: the springs carry γ l(q̄), where q̄ thinks they carry l(q̄).

        γ l(q̄) + Jᵀ F = G q,   q = q̄ + (1 - γ) K_J⁻¹ l(q̄)
        """
        gamma = share(self.rho)
        link = np.eye(7) - (1 - gamma) * self.stiffness / K_J[:, None]  # q by q̄
        q_bar = np.linalg.solve(gamma * self.stiffness + self.G @ link, self.J.T @ wrench)
        return self.J @ link @ q_bar
