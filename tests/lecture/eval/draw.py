"""Random inputs of every law, seeded."""

import numpy as np
from scipy.spatial.transform import Rotation

MODES = ("log", "quat", "log_simple", "quat_simple", "rpy")
BIASES = ("none", "gravity", "gravity+coriolis")


class Draw:
    """Numbers for an arm (or for `n` joints without one)."""

    def __init__(self, seed, arm=None, n=3):
        self.random = np.random.default_rng(seed)
        self.arm = arm
        self.n = arm.n if arm else n
        self.m = arm.m if arm else 6

    def vector(self, size, scale=1.0):
        return scale * self.random.standard_normal(size)

    def definite(self, size, low, high):
        """Symmetric, eigenvalues between the two, no axis preferred."""
        basis, _ = np.linalg.qr(self.random.standard_normal((size, size)))
        return basis @ np.diag(self.random.uniform(low, high, size)) @ basis.T

    def tip_matrix(self, scale):
        """Translation and rotation coupled, of units that differ by a factor of 40."""
        units = np.diag([1.0] * 3 + [0.16] * 3)[: self.m, : self.m]
        return scale * units @ self.definite(self.m, 0.3, 1.5) @ units

    def one_of(self, words):
        return words[self.random.integers(len(words))]

    def q(self):
        if self.arm.planar:
            q2 = self.random.choice([-1, 1]) * self.random.uniform(0.4, 2.6)
            return np.array([self.random.uniform(-3, 3), q2])
        return self.random.uniform(-1.3, 1.3, self.n)

    def joint_goal(self):
        q = self.q()
        q_d = q + self.vector(self.n, 0.2)
        return {"q": q, "v": self.vector(self.n), "q_d": q_d, "v_d": self.vector(self.n)}

    def tip_goal(self, q, angle=None):
        p_d = self.arm.p(q) + self.vector(len(self.arm.p(q)), 0.1)
        if self.arm.planar:
            return {"p_d": p_d}
        axis = self.vector(3)
        angle = self.random.uniform(0, 3.0) if angle is None else angle
        turn = Rotation.from_rotvec(angle * axis / np.linalg.norm(axis)).as_matrix()
        return {"p_d": p_d, "R_d": turn @ self.arm.R(q)}

    def impedance(self):
        q = self.q()
        mode = {} if self.arm.planar else {"mode": self.one_of(MODES)}
        return {
            "q": q,
            "v": self.vector(self.n),
            **self.tip_goal(q),
            "Kx": self.tip_matrix(900.0),
            "Dx": self.tip_matrix(60.0),
            **mode,
        }

    def motion(self):
        return {"V_d": self.vector(self.m), "A_d": self.vector(self.m), "F_ff": self.vector(self.m)}

    def joint_matrix(self, scale):
        return scale * self.definite(self.n, 0.3, 1.5)

    def diagonal(self, scale):
        return scale * self.random.uniform(0.5, 1.5, self.n)

    def history(self, count, scale=1.0):
        return self.vector((count, self.n), scale)


def arm_inputs(law, d: Draw):
    """Inputs of a law of an arm."""
    goal = d.joint_goal()
    moving = goal | {"a_d": d.vector(d.n)}
    tip = d.impedance()
    word = {"bias": d.one_of(BIASES)}
    still = {key: value for key, value in tip.items() if key not in ("v", "Dx")}
    if law == "kin_dyn":
        return {"q": tip["q"], "v": tip["v"], "W": d.vector(d.m, 20.0)}
    if law == "pose_error":
        return {"q": tip["q"], **d.tip_goal(tip["q"])}
    if law == "joint_pd":
        return goal | word | {"Kp": d.joint_matrix(100.0), "Kv": d.joint_matrix(10.0)}
    if law == "salisbury":
        return goal | word | {"Kx": tip["Kx"], "Kv": d.joint_matrix(10.0)}
    if law == "cartesian_impedance":
        return tip | word | d.motion() | {"inertia_ff": bool(d.random.integers(2))}
    if law == "eq4":
        return still
    if law == "eq7":
        choices = {
            "which": d.one_of(("first", "first+geometric", "full")),
            "pose": d.one_of(("current", "desired", "mid", "mean")),
            "use_vd": bool(d.random.integers(2)),
        }
        at_goal = d.tip_goal(goal["q_d"], angle=0.1)
        return goal | choices | word | at_goal | {"Kx": tip["Kx"], "Dx": tip["Dx"]}
    if law == "computed_torque":
        return moving | {"Kp_acc": d.joint_matrix(100.0), "Kv_acc": d.joint_matrix(20.0)}
    if law == "pd_plus":
        return moving | {"Kp": d.joint_matrix(100.0), "Kv": d.joint_matrix(10.0)}
    if law == "joint_impedance":
        shape = {"Md": d.joint_matrix(2.0), "Bd": d.joint_matrix(10.0), "Kd": d.joint_matrix(100.0)}
        return moving | shape | {"tau_ext": d.vector(d.n, 5.0)}
    if law == "opspace_impedance":
        return tip | d.motion() | {"Md": d.tip_matrix(4.0), "F_ext": d.vector(d.m, 10.0)}
    if law == "accel_feedback":
        return tip | {"Mx": d.tip_matrix(2.0), "V_meas_dot": d.vector(d.m, 3.0)}
    if law == "nullspace":
        posture = {"q_n": d.q(), "Kn": d.joint_matrix(20.0), "Dn": d.joint_matrix(2.0)}
        word = {"projector": d.one_of(("dynamic", "kinematic"))}
        return {"q": tip["q"], "v": tip["v"]} | posture | word
    if law == "damping_design":
        return {"q": tip["q"], "Kx": tip["Kx"], "zeta": d.random.uniform(0.1, 1.2)}
    if law == "singularity":
        return {"q": tip["q"], "sigma0": d.one_of((1e-3, 0.5)), "lam_max": 0.07}
    if law == "tomei":
        gains = {"K": d.diagonal(2000.0), "KP": d.joint_matrix(300.0), "KD": d.joint_matrix(20.0)}
        return {"theta": d.q(), "thetad": d.vector(d.n), "q_d": d.q()} | gains
    if law == "qbar":
        # soft enough at the joints for the fixpoint of the reference to contract
        theta = still.pop("q")
        goal = d.tip_goal(theta, angle=0.3)
        return still | goal | {"theta": theta, "Kx": tip["Kx"] / 10, "K": d.diagonal(3000.0)}
    if law == "flex_rhs":
        q = tip["q"]
        elastic = {"K": d.diagonal(2000.0), "D": d.diagonal(3.0), "B": d.diagonal(0.5)}
        motor = {"theta": q + d.vector(d.n, 0.01), "thetad": d.vector(d.n)}
        torques = {"tau_m": d.vector(d.n, 10.0), "tau_f": d.vector(d.n)}
        world = {"F_ext": d.vector(d.m, 10.0)}
        return {"q": q, "v": tip["v"]} | elastic | motor | torques | world
    if law == "vsa_cartesian":
        return {"q": tip["q"], "Kx": np.diag(np.diag(tip["Kx"]))}
    if law == "momentum_seq":
        T, count = 1e-3, 20
        v = d.vector(d.n) + np.outer(np.arange(count) * T, d.vector(d.n, 5.0))
        q = tip["q"] + np.cumsum(T * v, axis=0)
        return {"KO": d.diagonal(50.0), "T": T, "q": q, "v": v, "tau": d.history(count, 10.0)}
    raise KeyError(law)


def other_inputs(law, d: Draw):
    """Inputs of a law without an arm."""
    n = d.n
    if law == "torque_feedback":
        signals = {"u": d.vector(n), "tau": d.vector(n), "taud": d.vector(n, 100.0)}
        drive = {"B": d.diagonal(0.8), "Btheta": d.diagonal(0.2)}
        return signals | drive | {"K": d.diagonal(5000.0), "D": d.diagonal(5.0)}
    if law == "full_state":
        signals = {
            "theta_err": d.vector(n),
            "thetad": d.vector(n),
            "tau": d.vector(n, 9.0),
            "taud": d.vector(n, 100.0),
            "g_ff": d.vector(n, 9.0),
        }
        gains = {key: d.joint_matrix(scale) for key, scale in (("KP", 900.0), ("KD", 20.0))}
        torque = {"KT": d.joint_matrix(3.0), "KS": d.joint_matrix(5.0), "K": d.diagonal(5000.0)}
        return signals | gains | torque
    if law == "deflection_pd":
        state = {key: d.vector(n) for key in ("q", "v", "theta", "thetad")}
        return state | {"Kpm": d.joint_matrix(100.0), "Kvm": d.joint_matrix(5.0)}
    if law == "vsa":
        sigma, k2 = d.random.uniform(20, 200), d.random.uniform(100, 600)
        tau = d.random.uniform(-2, 2) * sigma**2 / (2 * k2)
        return {"sigma": sigma, "tau": tau, "q": d.vector(None), "k2": k2}
    if law == "interpolation":
        start, end = Rotation.random(2, random_state=int(d.random.integers(1000))).as_matrix()
        T = d.random.uniform(0.5, 3)
        t = T * d.random.uniform(0, 1.2)
        return {"p0": d.vector(3), "R0": start, "p1": d.vector(3), "R1": end, "T": T, "t": t}
    if law == "contact":
        n = d.vector(3)
        plane = {"n": n / np.linalg.norm(n), "p0": d.vector(3)}
        point = {"p": plane["p0"] + d.vector(3, 0.01), "v": d.vector(3, 0.5)}
        return plane | point | {"k": 1e4, "b": 30.0, "k_hc": 1e6, "b_hc": 0.6}
    if law == "admittance_seq":
        gains = {"M": d.joint_matrix(2.0), "D": d.joint_matrix(20.0), "K": d.joint_matrix(300.0)}
        return gains | {"T": 0.004, "F": d.history(60, 10.0)}
    if law == "velocity_seq":
        t = 1e-3 * np.arange(200)
        x = np.round((np.sin(9 * t) + d.vector(None) * t) / 4e-4) * 4e-4
        return {"T": 1e-3, "wc": 200.0, "sigma_a": 40.0, "sigma_x": 1e-4, "L": 100.0, "x": x}
    if law == "friction_seq":
        signals = {key: d.history(50, 3.0) for key in ("thetad", "tau_m", "tau")}
        return {"B": d.diagonal(0.5), "L": d.diagonal(80.0), "T": 1e-3} | signals
    if law == "tank_seq":
        K_req = np.array([d.joint_matrix(500.0) for _ in range(40)])
        limits = {"E0": 0.5, "Emax": 1.0, "Emin": 0.1, "share": 0.8, "T": 2e-3}
        signals = {"e": d.history(40, 0.05), "V": d.history(40)}
        return limits | signals | {"D": d.joint_matrix(20.0), "K_req": K_req}
    if law == "limit_seq":
        limits = {"tau_max": d.diagonal(5.0), "rate_max": d.diagonal(2000.0), "T": 1e-3}
        return limits | {"tau0": d.vector(n), "tau": d.history(60, 6.0)}
    raise KeyError(law)
