"""The controller's own equations of a flexible arm and its torque feedback, at random states."""

import numpy as np

from limber.model.robot import load_robot
from limber_lecture.context import Comparison, Context, case, near_zero

from .arm import D_J, K_J, ROBOT, B

STATES, RHO = 10, 4.0


def checks(context: Context) -> list[Comparison]:
    """Residuals of M q̈ + C q̇ + g = τ_t + Jᵀ F and B θ̈ = τ_m - τ_t - τ_f; motors as if B/ρ."""
    robot, rng = load_robot(ROBOT), context.rng
    q, v, theta_dot, tau_f, u = rng.uniform(-1.0, 1.0, (5, STATES, 7))
    theta, u = q + 5e-3 * rng.uniform(-1.0, 1.0, q.shape), 50 * u
    F = rng.uniform(-20.0, 20.0, (STATES, 6))
    tau, tau_dot = K_J * (theta - q), K_J * (theta_dot - v)
    tau_t = tau + D_J * (theta_dot - v)
    motor = {"B": B, "K": K_J, "D": D_J}
    each = range(STATES)
    feedback = [
        case("torque_feedback", u=u[i], tau=tau[i], taud=tau_dot[i], Btheta=B / RHO, **motor)
        for i in each
    ]
    tau_m = np.array([answer["tau_m"] for answer in context.eval(feedback)])
    states = [{"q": q[i], "v": v[i], "theta": theta[i], "thetad": theta_dot[i]} for i in each]
    torques = [{"tau_m": tau_m[i], "tau_f": tau_f[i], "F_ext": F[i]} for i in each]
    rates = context.eval(
        [case("flex_rhs", ROBOT, **states[i], **torques[i], **motor) for i in each]
    )
    qdd, thetadd = (np.array([rate[key] for rate in rates]) for key in ("qdd", "thetadd"))
    pushed = np.array([robot.chain.jacobian(at).T @ f for at, f in zip(q, F, strict=True)])
    named = {
        "links move as Newton and Euler say": robot.dynamics.torque(q, v, qdd) - tau_t - pushed,
        "motors move as their torques say": B * thetadd - (tau_m - tau_t - tau_f),
        "behind torque feedback a motor is a quarter as heavy and sticks a quarter as much": (
            B / RHO * thetadd - (u - tau_t - tau_f / RHO)
        ),
    }
    return [
        near_zero(f"{name}, off by", np.abs(off).max(), "N m", 1e-8) for name, off in named.items()
    ]
