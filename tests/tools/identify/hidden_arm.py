"""A random arm with a hidden truth, and what its sensors would say: formulas of their own.

Torques come from the energies of its bodies, tau = sum J_v' m (a - g) + J_w' (I w' + w x I w), and
not from a recursion; friction, motors and sensors are written out here. Every joint turns.
"""

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

from limber.identify.recording import Recording

RATE_HZ = 200.0
GRAVITY = np.array([0.0, 0.0, -9.81])
GEAR, CONSTANT, REACH = 50.0, 0.1, 0.35  # N m/A at the rotor; m from joint to joint
POSES, FURTHEST = 5, 1.2  # of a tour; rad
WEIGHED = 0.01  # share by which masses that were weighed are off


@dataclass(frozen=True)
class Body:
    mass: float
    com: np.ndarray
    inertia: np.ndarray  # about the centre


@dataclass(frozen=True)
class Joint:
    """Behind the gear: friction in N m, N m s/rad and rad/s, rotor in kg m², spring in N m/rad."""

    kappa: float
    offset: float
    coulomb: float
    viscous: float
    rise: float
    stribeck: float
    ripple: float  # N m, of teeth and magnets
    rotor: float
    sensor: bool
    spring: float
    delay_s: float

    def friction(self, v: np.ndarray) -> np.ndarray:
        bell = np.exp(-((v / self.stribeck) ** 2))
        return (self.coulomb + self.rise * bell) * np.tanh(v / 1e-3) + self.viscous * v


@dataclass(frozen=True)
class HiddenArm:
    """`urdf`: bodies as the URDF has them; `bodies` and `joints` are the truth."""

    seed: int
    axes: list[np.ndarray]
    urdf: list[Body]
    bodies: list[Body]
    joints: list[Joint]

    @property
    def weighed(self) -> bool:
        return self.seed % 3 == 1

    def torque(self, bodies, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        """Of the links alone."""
        N, n = q.shape
        R, p = np.tile(np.eye(3), (N, 1, 1)), np.zeros((N, 3))
        w, wd, acc = np.zeros((3, N, 3))
        z, origin, tau = [], [], np.zeros((N, n))
        for i, body in enumerate(bodies):
            step = R @ np.array([0.0, 0.0, REACH if i else 0.0])
            acc = acc + np.cross(wd, step) + np.cross(w, np.cross(w, step))
            p = p + step
            z.append(R @ self.axes[i])
            origin.append(p)
            wd = wd + z[i] * a[:, [i]] + np.cross(w, z[i] * v[:, [i]])
            w = w + z[i] * v[:, [i]]
            R = R @ turned(self.axes[i], q[:, i])
            c = R @ body.com
            force = body.mass * (acc + np.cross(wd, c) + np.cross(w, np.cross(w, c)) - GRAVITY)
            inertia = R @ body.inertia @ R.transpose(0, 2, 1)
            moment = np.einsum("nij,nj->ni", inertia, wd)
            moment += np.cross(w, np.einsum("nij,nj->ni", inertia, w))
            for k in range(i + 1):
                lever = np.cross(z[k], p + c - origin[k])
                tau[:, k] += np.sum(lever * force + z[k] * moment, axis=1)
        return tau


def turned(axis: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Rodrigues' formula, one matrix a sample."""
    x, y, z = axis
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    s, c = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    return np.eye(3) + s * K + (1.0 - c) * (K @ K)


def random_arm(seed: int) -> HiddenArm:
    """Two to five joints. One arm of three has torque sensors, of one the links were weighed."""
    rng = np.random.default_rng(seed)
    share = WEIGHED if seed % 3 == 1 else 0.15
    n = int(rng.integers(2, 6))
    axes = [np.eye(3)[rng.integers(3)] for _ in range(n)]
    urdf = [_body(rng, 5.0 * 0.7**i) for i in range(n)]
    bodies = [
        Body(
            body.mass * rng.lognormal(0.0, share),
            body.com + rng.normal(0.0, 0.15 * share, 3),
            body.inertia * rng.lognormal(0.0, 0.15),
        )
        for body in urdf
    ]
    return HiddenArm(seed, axes, urdf, bodies, [_joint(rng, i, seed % 3 == 0) for i in range(n)])


def _body(rng: np.random.Generator, mass: float) -> Body:
    size = rng.uniform(0.03, 0.08, 3)
    com = np.array([0.0, 0.0, REACH / 2]) + rng.normal(0.0, 0.03, 3)
    inertia = mass * np.diag(size[[1, 0, 0]] ** 2 + size[2] ** 2)
    return Body(mass * rng.uniform(0.7, 1.3), com, inertia)


def _joint(rng: np.random.Generator, i: int, sensor: bool) -> Joint:
    strength = 4.0 * 0.7**i
    coulomb = strength * rng.uniform(0.2, 1.0)
    return Joint(
        kappa=rng.normal(1.0, 0.05),
        offset=strength * rng.normal(0.0, 0.03),
        coulomb=coulomb,
        viscous=strength * rng.uniform(0.05, 0.8),
        rise=coulomb * rng.choice([0.0, rng.uniform(0.1, 0.5)]),
        stribeck=rng.uniform(0.05, 0.15),
        ripple=coulomb * rng.uniform(0.0, 0.05),
        rotor=rng.uniform(0.1, 0.5) * 0.7**i,
        sensor=sensor,
        spring=rng.uniform(3000.0, 12000.0),
        delay_s=rng.choice([0.0, 1e-3]) if sensor else 0.0,
    )


def motion(arm: HiddenArm, seed: int) -> np.ndarray:
    """Angles through random poses and back, slow, then fast, then a creep; N x n."""
    rng = np.random.default_rng([arm.seed, seed])
    share = [rng.permutation(POSES) / (POSES - 1) for _ in arm.joints]
    poses = FURTHEST * (2.0 * np.array(share).T - 1.0)
    tour = [*poses, *poses[-2::-1]]
    creep = [tour[-1], tour[-1] + 0.15, tour[-1] - 0.15, tour[-1]]
    return np.vstack([_moves(tour, 2.5, 0.3), _moves(tour, 1.0, 0.1), _moves(creep, 4.0, 0.1)])


def _moves(points: list[np.ndarray], seconds: float, rest: float) -> np.ndarray:
    """Along polynomials of degree seven, so that accelerations change smoothly."""
    x = np.arange(1, int(seconds * RATE_HZ) + 1) / (seconds * RATE_HZ)
    s = x**4 * (35.0 - 84.0 * x + 70.0 * x**2 - 20.0 * x**3)
    still = np.ones(int(rest * RATE_HZ))
    ways = pairwise(points)
    return np.vstack([a + np.concatenate([s, still])[:, None] * (b - a) for a, b in ways])


def record(arm: HiddenArm, seed: int) -> Recording:
    """What drives and sensors report of that motion."""
    rng = np.random.default_rng([arm.seed, seed, 1])
    q = motion(arm, seed)
    v = np.gradient(q, 1.0 / RATE_HZ, axis=0)
    a = np.gradient(v, 1.0 / RATE_HZ, axis=0)
    load = arm.torque(arm.bodies, q, v, a)
    sensors = np.array([joint.sensor for joint in arm.joints])
    theta, late, motor = q.copy(), q.copy(), np.empty_like(q)
    for i, joint in enumerate(arm.joints):
        if joint.sensor:
            theta[:, i] += load[:, i] / joint.spring
            time_s = np.arange(len(q)) / RATE_HZ
            late[:, i] = CubicSpline(time_s, q[:, i])(np.maximum(time_s - joint.delay_s, 0.0))
        w = np.gradient(theta[:, i], 1.0 / RATE_HZ)
        inertial = joint.rotor * np.gradient(w, 1.0 / RATE_HZ)
        ripple = joint.ripple * np.sin(40.0 * theta[:, i] + joint.offset)
        true = load[:, i] + inertial + joint.friction(w) + ripple
        motor[:, i] = true / joint.kappa + joint.offset
    noise = [rng.normal(0.0, std, q.shape) for std in (1e-5, 1e-5, 0.05, 0.05)]
    return Recording(
        rate_hz=RATE_HZ,
        q=late + noise[0] if sensors.any() else theta + noise[1],
        theta=theta + noise[1],
        preload=np.zeros_like(q),
        motor=motor + noise[2],
        tau=np.where(sensors, load + noise[3], 0.0),
        torque_sensor=sensors,
        link_encoder=sensors,
    )


def write_robot(arm: HiddenArm, folder: Path) -> Path:
    """robot.urdf and robot.yaml as they are believed: guesses of friction, springs, constants."""
    links = ['<link name="base"/>']
    for i, body in enumerate(arm.urdf):
        parent = f"l{i - 1}" if i else "base"
        (xx, yy, zz), com = np.diag(body.inertia), " ".join(map(str, body.com))
        axis = " ".join(map(str, arm.axes[i]))
        links.append(f"""<link name="l{i}"><inertial><origin xyz="{com}"/>
  <mass value="{body.mass}"/><inertia ixx="{xx}" iyy="{yy}" izz="{zz}" ixy="0" ixz="0" iyz="0"/>
</inertial></link><joint name="j{i}" type="revolute"><parent link="{parent}"/>
  <child link="l{i}"/><origin xyz="0 0 {REACH if i else 0.0}"/><axis xyz="{axis}"/>
  <limit lower="-3" upper="3" velocity="6" effort="200"/></joint>""")
    (folder / "robot.urdf").write_text(f'<robot name="hidden">{"".join(links)}</robot>')
    joints, motors = [], []
    for i, joint in enumerate(arm.joints):
        motors.append(f"""  m{i}: {{protocol: cia402, gear_ratio: {GEAR},
    rotor_inertia_kgm2: {joint.rotor / GEAR**2}, rotor_torque_constant_Nm_per_A: {CONSTANT},
    phase_resistance_ohm: 0.2, peak_torque_Nm: 200, rated_torque_Nm: 200, encoder_bits: 18}}""")
        spring = "transmission: {kind: elastic, spring: {law: linear, stiffness_Nm_per_rad: 7000}}"
        friction = "friction: {coulomb_Nm: 1, viscous_Nms_per_rad: 0.5}"
        drive = f"motor: m{i}, bus: arm, id: {i + 1}, home_rad: 0"
        drive += ", hold: {kp_Nm_per_rad: 40, kd_Nms_per_rad: 5}"
        joints.append(f"  j{i}: {{{drive}, {spring if joint.sensor else ''}, {friction}}}")
    text = "\n".join(["motors:", *motors, "joints:", *joints]).replace(", ,", ",")
    (folder / "robot.yaml").write_text(f"""format: limber-robot/1
name: hidden
urdf: robot.urdf
base: base
tip: l{len(arm.joints) - 1}
rate_hz: 200
buses: [{{name: arm, can: "virtual:hidden", bitrate_bps: 1000000}}]
{text}
gains: {{K_q_Nm_per_rad: 400, K_x_translation_N_per_m: 500, K_x_rotation_Nm_per_rad: 20,
  joint_damping_ratio: 0.7, damping_ratio: 0.7, K_null_Nm_per_rad: 0, D_null_Nms_per_rad: 1}}
watchdog: {{timeout_s: 0.1, reaction: damp}}
""")
    return folder
