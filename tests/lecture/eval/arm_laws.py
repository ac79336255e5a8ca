"""What each law of an arm gives, from its equation; arguments are the inputs by their names."""

import numpy as np
from scipy.linalg import block_diag, eigh, sqrtm
from scipy.optimize import nnls

import orientation
from arms import Dynamics


def pose_error(arm: Dynamics, q, i):
    """e and A of the task."""
    e_p = arm.p(q) - i["p_d"]
    if arm.planar:
        return e_p, np.eye(2)
    e_o, A_o = orientation.error(i.get("mode", "log"), arm.R(q), i["R_d"])
    return np.concatenate([e_p, e_o]), block_diag(np.eye(3), A_o)


def spring(arm, q, i):
    e, A = pose_error(arm, q, i)
    return A.T @ i["Kx"] @ e


def bias(arm, q, v, word):
    tau = np.zeros(arm.n)
    if word != "none":
        tau = tau + arm.g(q)
    if word == "gravity+coriolis":
        tau = tau + arm.C(q, v) @ v
    return tau


def Lambda(arm, q):
    J = arm.J(q)
    return np.linalg.inv(J @ np.linalg.solve(arm.M(q), J.T))


def first_term(arm, q, i):
    AJ = pose_error(arm, q, i)[1] @ arm.J(q)
    return AJ.T @ i["Kx"] @ AJ


def full_tangent(arm, q, i):
    h = 1e-5
    columns = []
    for step in h * np.eye(arm.n):
        above = arm.J(q + step).T @ spring(arm, q + step, i)
        below = arm.J(q - step).T @ spring(arm, q - step, i)
        columns.append((above - below) / (2 * h))
    return np.array(columns).T


def kin_dyn(arm, q, v, W):
    C = arm.C(q, v)
    R = arm.R(q)
    x, y, z, w = orientation.Rotation.from_matrix(R).as_quat(canonical=True)
    return {
        "p": arm.p(q),
        "R": R,
        "quat_wxyz": np.array([w, x, y, z]),
        "J": arm.J(q),
        "Jdot_v": arm.Jdot_v(q, v),
        "M": arm.M(q),
        "Cv": C @ v,
        "CTv": C.T @ v,
        "g": arm.g(q),
        "Lambda": Lambda(arm, q),
        "KG": arm.K_G(q, W),
    }


def pose_errors(arm, q, p_d, R_d=None):
    out = {"e_p": arm.p(q) - p_d}
    if arm.planar:
        return out
    for mode in ("log", "quat", "rpy"):
        out[f"e_{mode}"], out[f"A_{mode}"] = orientation.error(mode, arm.R(q), R_d)
    return out


def joint_pd(arm, q, v, q_d, v_d, Kp, Kv, bias):
    return {"tau": globals()["bias"](arm, q, v, bias) - Kp @ (q - q_d) - Kv @ (v - v_d)}


def salisbury(arm, q, v, q_d, v_d, Kx, Kv, bias):
    Kq = arm.J(q).T @ Kx @ arm.J(q)
    return {**joint_pd(arm, q, v, q_d, v_d, Kq, Kv, bias), "Kq": Kq}


def cartesian_impedance(arm, **i):
    q, v = i["q"], i["v"]
    J = arm.J(q)
    F = -spring(arm, q, i) - i["Dx"] @ (J @ v - i.get("V_d", 0)) + i.get("F_ff", 0)
    if i.get("inertia_ff"):
        F = F + Lambda(arm, q) @ (i["A_d"] - arm.Jdot_v(q, v))
    tau = bias(arm, q, v, i["bias"]) + J.T @ F
    return {"tau": tau, "e": pose_error(arm, q, i)[0], "F_c": F}


def eq4(arm, **i):
    q = i["q"]
    return {
        "first": first_term(arm, q, i),
        "geometric_fixed_wrench": arm.K_G(q, spring(arm, q, i)),
        "full": full_tangent(arm, q, i),
    }


def stiffness(arm, q, i):
    if i["which"] == "full":
        return full_tangent(arm, q, i)
    K = first_term(arm, q, i)
    return K + arm.K_G(q, spring(arm, q, i)) if i["which"] == "first+geometric" else K


def eq7(arm, **i):
    q, v, q_d, v_d = i["q"], i["v"], i["q_d"], i["v_d"]
    poses = {"current": [q], "desired": [q_d], "mid": [(q + q_d) / 2], "mean": [q, q_d]}
    at = poses[i["pose"]]
    Kp = sum(stiffness(arm, pose, i) for pose in at) / len(at)
    Kv = arm.J(q).T @ i["Dx"] @ arm.J(q)
    tau = bias(arm, q, v, i["bias"]) + Kp @ (q_d - q) + Kv @ (i["use_vd"] * v_d - v)
    return {"tau": tau, "Kp": Kp, "Kv": Kv}


def computed_torque(arm, q, v, q_d, v_d, a_d, Kp_acc, Kv_acc):
    a = a_d - Kp_acc @ (q - q_d) - Kv_acc @ (v - v_d)
    return {"tau": arm.M(q) @ a + arm.C(q, v) @ v + arm.g(q)}


def pd_plus(arm, q, v, q_d, v_d, a_d, Kp, Kv):
    feedforward = arm.M(q) @ a_d + arm.C(q, v) @ v_d + arm.g(q)
    return {"tau": feedforward - Kp @ (q - q_d) - Kv @ (v - v_d)}


def joint_impedance(arm, q, v, q_d, v_d, a_d, Md, Bd, Kd, tau_ext):
    a = a_d + np.linalg.solve(Md, tau_ext - Kd @ (q - q_d) - Bd @ (v - v_d))
    return {"tau": arm.M(q) @ a + arm.C(q, v) @ v + arm.g(q) - tau_ext, "a_ref": a}


def opspace_impedance(arm, **i):
    q, v, F_ext = i["q"], i["v"], i["F_ext"]
    J = arm.J(q)
    F = F_ext + i["F_ff"] - spring(arm, q, i) - i["Dx"] @ (J @ v - i["V_d"])
    a = i["A_d"] + np.linalg.solve(i["Md"], F)
    tau = J.T @ Lambda(arm, q) @ (a - arm.Jdot_v(q, v)) - J.T @ F_ext
    return {"tau": tau + arm.C(q, v) @ v + arm.g(q), "a_ref": a}


def accel_feedback(arm, **i):
    q, v = i["q"], i["v"]
    J = arm.J(q)
    F = -spring(arm, q, i) - i["Dx"] @ J @ v - i["Mx"] @ i["V_meas_dot"]
    return {"tau": J.T @ F + arm.C(q, v) @ v + arm.g(q)}


def nullspace(arm, q, v, q_n, Kn, Dn, projector):
    J = arm.J(q)
    W = np.linalg.inv(arm.M(q)) if projector == "dynamic" else np.eye(arm.n)
    N = np.eye(arm.n) - J.T @ np.linalg.solve(J @ W @ J.T, J @ W)
    return {"tau": N @ (-Kn @ (q - q_n) - Dn @ v), "N": N}


def damping_design(arm, q, Kx, zeta):
    inertia = Lambda(arm, q)
    k0, V = eigh(Kx, inertia)
    Q = np.linalg.inv(V)
    product = sqrtm(inertia).real @ sqrtm(Kx).real
    return {
        "Lambda": inertia,
        "D_double_diag": 2 * zeta * Q.T @ np.diag(np.sqrt(k0)) @ Q,
        "k0": k0,
        "D_factorization": zeta * (product + product.T),
    }


def singularity(arm, q, sigma0, lam_max):
    J = arm.J(q)
    sigma = np.linalg.svd(J, compute_uv=False)[-1]
    lam = lam_max * np.sqrt(max(0.0, 1 - (sigma / sigma0) ** 2))
    inverse = J.T @ np.linalg.inv(J @ J.T + lam**2 * np.eye(arm.m))
    return {"sigma_min": sigma, "lam": lam, "J_damped_pinv": inverse}


def tomei(arm, theta, thetad, q_d, K, KP, KD):
    g = arm.g(q_d)
    theta_d = q_d + g / K
    block = np.block([[np.diag(K), -np.diag(K)], [-np.diag(K), np.diag(K) + KP]])
    return {
        "tau_m": g - KP @ (theta - theta_d) - KD @ thetad,
        "theta_d": theta_d,
        "lambda_min": np.linalg.eigvalsh(block)[0],
    }


def qbar(arm, **i):
    q = i["theta"]
    for _ in range(300):
        u = arm.g(q) - arm.J(q).T @ spring(arm, q, i)
        q = i["theta"] - u / i["K"]
    return {"qbar": q, "u": i["K"] * (i["theta"] - q)}


def flex_rhs(arm, q, v, theta, thetad, K, D, B, tau_m, tau_f, F_ext):
    spring = K * (theta - q)
    passed = spring + D * (thetad - v)
    effort = passed + arm.J(q).T @ F_ext - arm.C(q, v) @ v - arm.g(q)
    return {
        "tau_spring": spring,
        "tau_transmitted": passed,
        "qdd": np.linalg.solve(arm.M(q), effort),
        "thetadd": (tau_m - passed - tau_f) / B,
    }


def vsa_cartesian(arm, q, Kx):
    J = arm.J(q)
    K = J.T @ Kx @ J
    off = K - np.diag(np.diag(K))
    W = np.sqrt(np.diag(np.diag(Kx)))
    columns = np.array([np.outer(W @ j, W @ j).ravel() for j in J.T]).T
    wanted = (W @ np.linalg.inv(Kx) @ W).ravel()
    s, missed = nnls(columns, wanted)
    return {
        "diag_stiffness": np.diag(K),
        "residual_stiffness": np.linalg.norm(off) / np.linalg.norm(K),
        "compliance": s,
        "residual_compliance_weighted": missed / np.linalg.norm(wanted),
    }


def momentum_seq(arm, KO, T, q, v, tau):
    acc = arm.M(q[0]) @ v[0]
    r = np.zeros(arm.n)
    out = [r]
    for k in range(1, len(q)):
        beta = arm.C(q[k - 1], v[k - 1]).T @ v[k - 1] - arm.g(q[k - 1])
        acc = acc + T * (tau[k - 1] + beta + r)
        r = KO * (arm.M(q[k]) @ v[k] - acc)
        out.append(r)
    return {"r": np.array(out)}


LAWS = {
    function.__name__: function
    for function in (
        kin_dyn,
        joint_pd,
        salisbury,
        cartesian_impedance,
        eq4,
        eq7,
        computed_torque,
        pd_plus,
        joint_impedance,
        opspace_impedance,
        accel_feedback,
        nullspace,
        damping_design,
        singularity,
        tomei,
        qbar,
        flex_rhs,
        vsa_cartesian,
        momentum_seq,
    )
} | {"pose_error": pose_errors}
