"""A recording of desktop2r's arm, from closed forms: two rods in a vertical plane."""

import numpy as np

from limber.identify.recording import Recording

RATE_HZ, LENGTH_S = 250.0, 30.0
RATED = 7.0  # N m, peak torque of its motors
A1, C1, C2 = 0.35, 0.21, 0.15  # m: length of the first link, centres of both
M1, M2 = 1.5, 0.8  # kg
ROTOR = 1.8e-3  # kg m², behind the gear
COULOMB, VISCOUS = (0.12, 0.08), (0.05, 0.02)  # N m, N m s/rad


def record() -> Recording:
    """Sines with no slow part; noise of 0.01 N m."""
    t = np.arange(0.0, LENGTH_S, 1.0 / RATE_HZ)
    q, v, a = (np.zeros((len(t), 2)) for _ in range(3))
    for i, (middle, waves) in enumerate(
        [(-0.7, [(0.9, 2.1), (0.3, 3.7)]), (0.6, [(0.8, 2.9), (0.4, 4.3)])]
    ):
        q[:, i] = middle + sum(A * np.sin(w * t) for A, w in waves)
        v[:, i] = sum(A * w * np.cos(w * t) for A, w in waves)
        a[:, i] = sum(-A * w**2 * np.sin(w * t) for A, w in waves)
    friction = np.sign(v) * COULOMB + v * VISCOUS
    motor = dynamics(q, v, a) + ROTOR * a + friction
    motor = motor + np.random.default_rng(1).normal(0.0, 0.01, motor.shape)
    nothing, no = np.zeros_like(q), np.zeros(2, bool)
    return Recording(RATE_HZ, q, q, nothing, motor, nothing, no, no)


def dynamics(q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
    """Lagrange's equations, gravity along -y. The links' own inertia: of desktop2r's URDF."""
    from limber.model.robot import load_robot

    I1, I2 = (body.inertial.inertia[2, 2] for body in load_robot("desktop2r").dynamics.bodies)
    c2, s2 = np.cos(q[:, 1]), np.sin(q[:, 1])
    h = M2 * A1 * C2
    M11 = I1 + I2 + M1 * C1**2 + M2 * (A1**2 + C2**2) + 2 * h * c2
    M12 = I2 + M2 * C2**2 + h * c2
    M22 = I2 + M2 * C2**2
    g = 9.81
    weight2 = M2 * g * C2 * np.cos(q.sum(axis=1))
    weight1 = (M1 * C1 + M2 * A1) * g * np.cos(q[:, 0]) + weight2
    tau1 = M11 * a[:, 0] + M12 * a[:, 1] - h * s2 * (2 * v[:, 0] + v[:, 1]) * v[:, 1] + weight1
    tau2 = M12 * a[:, 0] + M22 * a[:, 1] + h * s2 * v[:, 0] ** 2 + weight2
    return np.column_stack([tau1, tau2])


def text(recording: Recording) -> str:
    """As CSV."""
    time_s = np.arange(len(recording.q)) / recording.rate_hz
    rows = np.column_stack([time_s, recording.q, recording.motor])
    lines = [",".join(f"{x:.7g}" for x in row) for row in rows]
    return "t,q1,q2,m1,m2\n" + "\n".join(lines) + "\n"


def columns(scale: str = "") -> str:
    table = "format: limber-columns/1\ntime_s: t\nposition: q{}\nmotor_torque: m{}\n"
    return table + (f"scale: {{{scale}}}\n" if scale else "")
