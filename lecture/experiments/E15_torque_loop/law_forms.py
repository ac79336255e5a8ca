"""The controller's two forms of the law against the equation, and against each other."""

import numpy as np

from limber_lecture import testbench as bench
from limber_lecture.context import Comparison, Context, case, near_zero

RHO, K_PU, K_DU = 4.0, 100.0, 10.0
STATES = 20


def checks(context: Context) -> list[Comparison]:
    """Greatest difference at random states of the joint, N m."""
    scale = np.array([0.1, 2.0, 20.0, 500.0, 20.0])[:, None]
    error, speed, tau, rate, weight = context.rng.uniform(-1, 1, (5, STATES)) * scale
    u = weight - K_PU * error - K_DU * speed
    by_hand = RHO * u + (1 - RHO) * (tau + bench.D_J / bench.K_J * rate)
    feedback, full = [], []
    for i in range(STATES):
        sensed = {"tau": [tau[i]], "taud": [rate[i]], "K": [bench.K_J]}
        inertia = {"B": [bench.B], "Btheta": [bench.B / RHO], "D": [bench.D_J]}
        feedback.append(case("torque_feedback", u=[u[i]], **inertia, **sensed))
        gains = {"KP": [RHO * K_PU], "KD": [RHO * K_DU], "KT": [RHO - 1]}
        damper = {"KS": [(RHO - 1) * bench.D_J]}
        state = {"theta_err": [error[i]], "thetad": [speed[i]], "g_ff": [weight[i]]}
        full.append(case("full_state", **state, **gains, **damper, **sensed))
    made = []
    for name, cases in (("torque feedback", feedback), ("full-state feedback", full)):
        found = np.array([np.ravel(a["tau_m"])[0] for a in context.eval(cases)])
        name = f"{name} of the controller and the equation differ by"
        made.append(near_zero(name, np.abs(found - by_hand).max(), "N m", 1e-9))
    return made
