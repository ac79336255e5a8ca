"""What each law without an arm gives, from its equation, one joint at a time."""

import math

import numpy as np
from scipy.spatial.transform import Rotation


def torque_feedback(u, tau, taud, B, Btheta, K, D):
    rho = B / Btheta
    return {"tau_m": rho * u + (1 - rho) * (tau + D / K * taud)}


def full_state(theta_err, thetad, tau, taud, g_ff, KP, KD, KT, KS, K):
    law = g_ff - KP @ theta_err - KD @ thetad + KT @ (g_ff - tau) - KS @ (taud / K)
    return {"tau_m": law}


def deflection_pd(q, v, theta, thetad, Kpm, Kvm):
    return {"tau_m": -Kpm @ (theta - q) - Kvm @ (thetad - v)}


def vsa(sigma, tau, q, k2):
    theta1 = sigma / (2 * k2) + q + tau / sigma
    theta2 = sigma / (2 * k2) - q - tau / sigma
    first, second = max(theta1 - q, 0), max(theta2 + q, 0)
    return {
        "theta1": theta1,
        "theta2": theta2,
        "feasible": abs(tau) <= sigma**2 / (2 * k2),
        "tau_check": k2 / 2 * (first**2 - second**2),
        "sigma_check": k2 * (first + second),
    }


def interpolation(p0, R0, p1, R1, T, t):
    x = min(t / T, 1.0)
    s = 10 * x**3 - 15 * x**4 + 6 * x**5
    ds = (30 * x**2 - 60 * x**3 + 30 * x**4) / T
    dds = (60 * x - 180 * x**2 + 120 * x**3) / T**2
    phi = Rotation.from_matrix(R1 @ R0.T).as_rotvec()
    way = p1 - p0
    return {
        "p": p0 + s * way,
        "v": ds * way,
        "a": dds * way,
        "R": Rotation.from_rotvec(s * phi).as_matrix() @ R0,
        "w": ds * phi,
        "alpha": dds * phi,
    }


def contact(p, v, p0, n, k, b, k_hc, b_hc):
    depth, speed = -n @ (p - p0), n @ v
    if depth <= 0:
        return {"f_kv": 0 * n, "f_hc": 0 * n}
    return {
        "f_kv": max(0.0, k * depth - b * speed) * n,
        "f_hc": max(0.0, k_hc * depth**1.5 * (1 - b_hc * speed)) * n,
    }


def admittance_seq(M, D, K, T, F):
    x, v = np.zeros(len(M)), np.zeros(len(M))
    xs, vs = [], []
    for force in F:
        v = np.linalg.solve(M + T * D + T**2 * K, M @ v + T * (force - K @ x))
        x = x + T * v
        xs.append(x)
        vs.append(v)
    return {"x": np.array(xs), "v": np.array(vs)}


def velocity_seq(T, wc, sigma_a, sigma_x, L, x):
    a = math.exp(-wc * T)
    lam = sigma_a * T**2 / sigma_x
    r = (4 + lam - math.sqrt(8 * lam + lam**2)) / 4
    alpha = 1 - r**2
    beta = 2 * (2 - alpha) - 4 * math.sqrt(1 - alpha)
    difference, tracker, levant = [0.0], [0.0], [0.0]
    z0, z1 = x[0], 0.0
    position, v = x[0], 0.0
    for k in range(1, len(x)):
        difference.append(a * difference[-1] + (1 - a) * (x[k] - x[k - 1]) / T)
        predicted = position + T * v
        miss = x[k] - predicted
        position, v = predicted + alpha * miss, v + beta / T * miss
        tracker.append(v)
        sign = float(np.sign(z0 - x[k]))
        dz0 = -1.5 * math.sqrt(L * abs(z0 - x[k])) * sign + z1
        z0, z1 = z0 + T * dz0, z1 - T * 1.1 * L * sign
        levant.append(z1)
    return {
        "alpha": alpha,
        "beta": beta,
        "filtered_diff": np.array(difference),
        "alpha_beta": np.array(tracker),
        "levant": np.array(levant),
    }


def friction_seq(B, L, T, thetad, tau_m, tau):
    z = L * B * thetad[0]
    out = []
    for k in range(len(thetad)):
        out.append(z - L * B * thetad[k])
        z = z + T * L * (tau_m[k] - tau[k] - out[-1])
    return {"tau_f": np.array(out)}


def tank_seq(E0, Emax, Emin, share, D, T, K_req, e, V):
    K, E = K_req[0], E0
    Ks, Es = [], []
    for wanted, error, twist in zip(K_req, e, V, strict=True):
        cost = error @ (wanted - K) @ error / 2
        E = min(Emax, E + share * T * twist @ D @ twist)
        if cost <= 0:
            K = wanted
        else:
            phi = 1.0 if E - cost >= Emin else (E - Emin) / cost
            K = K + phi * (wanted - K)
            E = E - phi * cost
        Ks.append(K)
        Es.append(E)
    return {"K": np.array(Ks), "E": np.array(Es)}


def limit_seq(tau0, tau, tau_max, rate_max, T):
    out, last = [], tau0
    for wanted in tau:
        step = np.clip(np.clip(wanted, -tau_max, tau_max) - last, -rate_max * T, rate_max * T)
        last = last + step
        out.append(last)
    return {"tau": np.array(out)}


LAWS = {
    function.__name__: function
    for function in (
        torque_feedback,
        full_state,
        deflection_pd,
        vsa,
        interpolation,
        contact,
        admittance_seq,
        velocity_seq,
        friction_seq,
        tank_seq,
        limit_seq,
    )
}
