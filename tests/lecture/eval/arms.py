"""Arms by first principles, to compare with: a planar one in closed form, any other from its URDF.

Derivatives with respect to the joints are complex steps, exact to rounding: everything below is
analytic in q. No part of limber is used.
"""

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np

STEP = 1e-30


def cross(a: np.ndarray) -> np.ndarray:
    zero = 0.0 * a[0]
    return np.array([[zero, -a[2], a[1]], [a[2], zero, -a[0]], [-a[1], a[0], zero]])


def along(function, q: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """Derivative of function(q) along a direction."""
    return function(q + 1j * STEP * direction).imag / STEP


class Dynamics:
    """What follows from M(q), g(q) and J(q)."""

    n: int
    planar = False

    def dM(self, q):
        return [along(self.M, q, e) for e in np.eye(self.n)]

    def C(self, q, v):
        """Christoffel symbols of the first kind."""
        d = self.dM(q)
        n = range(self.n)
        entry = [
            [sum((d[k][i, j] + d[j][i, k] - d[i][j, k]) * v[k] for k in n) / 2 for j in n]
            for i in n
        ]
        return np.array(entry)

    def Jdot_v(self, q, v):
        return along(self.J, q, v) @ v

    def K_G(self, q, W):
        """Column k: derivative of J^T W with respect to q_k, W fixed."""
        return np.array([along(lambda x: self.J(x).T @ W, q, e) for e in np.eye(self.n)]).T


class Planar2R(Dynamics):
    """Rods l = (0.5, 0.4) m, m = (4, 2.5) kg in the x-y plane, gravity along -y."""

    n = 2
    m = 2
    planar = True
    l1, l2, m1, m2, gravity = 0.5, 0.4, 4.0, 2.5, 9.81
    c1, c2 = l1 / 2, l2 / 2
    I1, I2 = m1 * l1**2 / 12, m2 * l2**2 / 12

    def p(self, q):
        a, b = q[0], q[0] + q[1]
        return np.array(
            [
                self.l1 * np.cos(a) + self.l2 * np.cos(b),
                self.l1 * np.sin(a) + self.l2 * np.sin(b),
            ]
        )

    def R(self, q):
        c, s = np.cos(q[0] + q[1]), np.sin(q[0] + q[1])
        return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])

    def J(self, q):
        p = self.p(q)
        b = q[0] + q[1]
        p2 = self.l2 * np.array([np.cos(b), np.sin(b)])
        return np.array([[-p[1], -p2[1]], [p[0], p2[0]]])

    def M(self, q):
        cos2 = np.cos(q[1])
        M22 = self.I2 + self.m2 * self.c2**2
        M12 = M22 + self.m2 * self.l1 * self.c2 * cos2
        M11 = self.I1 + self.m1 * self.c1**2 + M22
        M11 = M11 + self.m2 * (self.l1**2 + 2 * self.l1 * self.c2 * cos2)
        return np.array([[M11, M12], [M12, M22]])

    def g(self, q):
        second = self.m2 * self.gravity * self.c2 * np.cos(q[0] + q[1])
        first = (self.m1 * self.c1 + self.m2 * self.l1) * self.gravity * np.cos(q[0])
        return np.array([first + second, second])


def numbers(element: ET.Element | None, name: str, default: str) -> np.ndarray:
    text = default if element is None else element.get(name, default)
    return np.array([float(word) for word in text.split()])


def rotation_rpy(rpy: np.ndarray) -> np.ndarray:
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    Rz = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    Ry = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    Rx = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    return Rz @ Ry @ Rx


def origin_of(element: ET.Element) -> tuple[np.ndarray, np.ndarray]:
    origin = element.find("origin")
    return rotation_rpy(numbers(origin, "rpy", "0 0 0")), numbers(origin, "xyz", "0 0 0")


class UrdfArm(Dynamics):
    """Serial chain of a URDF: links as rigid bodies, each with its Jacobian at its centre."""

    m = 6

    def __init__(self, path: Path, base: str, tip: str, gravity=(0.0, 0.0, -9.81)):
        root = ET.parse(path).getroot()
        by_child = {joint.find("child").get("link"): joint for joint in root.findall("joint")}
        self.links = {link.get("name"): link for link in root.findall("link")}
        self.chain = []
        while tip != base:
            self.chain.insert(0, by_child[tip])
            tip = by_child[tip].find("parent").get("link")
        self.gravity = np.array(gravity)
        self.n = sum(joint.get("type") != "fixed" for joint in self.chain)

    def frames(self, q):
        """Per link of the chain: joint axes and points so far, and the link's R and p."""
        R, p, i = np.eye(3), np.zeros(3), 0
        axes: list[tuple[str, np.ndarray, np.ndarray]] = []
        for joint in self.chain:
            R_o, p_o = origin_of(joint)
            p = p + R @ p_o
            R = R @ R_o
            kind = joint.get("type")
            if kind != "fixed":
                axis = numbers(joint.find("axis"), "xyz", "1 0 0")
                axis = axis / np.linalg.norm(axis)
                axes.append((kind, R @ axis, p))
                if kind == "prismatic":
                    p = p + R @ axis * q[i]
                else:
                    K = cross(axis)
                    R = R @ (np.eye(3) + np.sin(q[i]) * K + (1 - np.cos(q[i])) * K @ K)
                i += 1
            yield joint.find("child").get("link"), list(axes), R, p

    def jacobian(self, axes, at):
        columns = []
        for kind, z, p in axes:
            if kind == "prismatic":
                columns.append(np.concatenate([z, 0 * z]))
            else:
                columns.append(np.concatenate([cross(z) @ (at - p), z]))
        columns += [np.zeros(6)] * (self.n - len(columns))
        return np.array(columns).T

    def bodies(self, q):
        """Mass, inertia about the centre in base axes, Jacobian at the centre."""
        for name, axes, R, p in self.frames(q):
            inertial = self.links[name].find("inertial")
            if inertial is None:
                continue
            R_c, c = origin_of(inertial)
            moments = inertial.find("inertia")
            xx, xy, xz, yy, yz, zz = (
                float(moments.get(k)) for k in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
            )
            R_c = R @ R_c
            inertia = R_c @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ R_c.T
            mass = float(inertial.find("mass").get("value"))
            yield mass, inertia, self.jacobian(axes, p + R @ c)

    def tip(self, q):
        return list(self.frames(q))[-1]

    def p(self, q):
        return self.tip(q)[3]

    def R(self, q):
        return self.tip(q)[2]

    def J(self, q):
        _, axes, _, p = self.tip(q)
        return self.jacobian(axes, p)

    def M(self, q):
        parts = (
            m * J[:3].T @ J[:3] + J[3:].T @ inertia @ J[3:] for m, inertia, J in self.bodies(q)
        )
        return sum(parts)

    def g(self, q):
        return -sum(m * J[:3].T @ self.gravity for m, _, J in self.bodies(q))
