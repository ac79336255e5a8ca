"""What a torque loop in the drive gives, and how much of it a rate allows."""

import numpy as np

from limber_lecture import testbench as bench
from limber_lecture.context import Comparison, Context, ideal_and_bus

from . import bus, controller_loop, drawing, ideal, law_forms

TITLE = "A torque loop divides motor inertia and friction; its rate limits by how much"
CLAIM = "Sensing the torque makes the arm get the torque it asks for, if the torque loop runs even"
CLAIM += " faster than the impedance loop"
SECTION = "3.2"
PLANT = "rotor of 0.2 kg m² behind a spring of 5000 N m/rad: its equations (ideal), and the test"
PLANT += " bench with the loop in its drive (bus)"
FAST = False

RATIOS = (1.0, 4.0, 8.0)
RATES_HZ = (1e3, 4e3, 1e4)
KAPPA, PUSH_NM, COULOMB_NM, BIAS_NM = 0.8, 10.0, 2.0, 1.0


def run(context: Context) -> list[Comparison]:
    limits = [
        drawing.Limit(
            rate,
            samples,
            ideal.most_ratio_found(rate, samples),
            bus.most_ratio(context, rate, samples, ideal.most_ratio(rate, samples)),
        )
        for rate in RATES_HZ
        for samples in (0, 1)
    ]
    effects = [effect(context, rho) for rho in RATIOS]
    with context.picture(TITLE, columns=2, size=(13.5, 5.2)) as (left, right):
        drawing.limits(limits, left)
        drawing.effects(effects, KAPPA, right)
    return [
        *(check for found in effects for check in effect_checks(found)),
        *(check for limit in limits for check in limit.checks()),
        *controller_loop.checks(context, KAPPA, PUSH_NM),
        *(check for rho in (1.0, 4.0) for check in ring(context, rho)),
        *law_forms.checks(context),
    ]


def effect(context: Context, rho: float) -> drawing.Effect:
    """On the law outside: share of its torque that arrives, lag by friction, push by a bias."""
    return drawing.Effect(
        rho,
        ideal=(
            PUSH_NM / (ideal.K * ideal.at_rest(rho, KAPPA, push=PUSH_NM)),
            ideal.friction_lag(rho, COULOMB_NM) * ideal.K / COULOMB_NM,
            ideal.K * ideal.at_rest(rho, bias=BIAS_NM) / BIAS_NM,
        ),
        bus=(
            bus.shared(context, rho, KAPPA, PUSH_NM),
            bus.friction_lag(context, rho, COULOMB_NM) * ideal.K / COULOMB_NM,
            bus.biased(context, rho, BIAS_NM) / BIAS_NM,
        ),
    )


def effect_checks(found: drawing.Effect) -> list[Comparison]:
    """Lag and bias in their own units."""
    name, lag = f"inertia ratio {found.rho:g}", COULOMB_NM / ideal.K * 1e3
    shares, frictions, biases = zip(found.ideal, found.bus, strict=True)
    lags, torques = np.array(frictions) * lag, np.array(biases) * BIAS_NM
    gained, missing = ideal.gained(found.rho, KAPPA), (1 / found.rho - 1) * BIAS_NM
    bias = f"torque made by a bias of {BIAS_NM:g} N m, {name}"
    return [
        *ideal_and_bus(f"friction lag, {name}", lag / found.rho, *lags, "mrad", 0.02),
        *ideal_and_bus(f"share of the torque, {name}", gained, *shares, "", 0.01),
        *ideal_and_bus(bias, missing, *torques, "N m", 0.01, "absolute"),
    ]


def ring(context: Context, rho: float) -> list[Comparison]:
    """√(K_J ρ/B) and D_J/(2 √(K_J B/ρ)), link held."""
    omega = (rho * bench.K_J / bench.B) ** 0.5
    zeta = bench.D_J / (2 * (bench.K_J * bench.B / rho) ** 0.5)
    exact = bench.slowest(ideal.loop_with_rate(rho), ideal.FINE_S)
    drive = bench.slowest(ideal.loop_of_drive(rho, bus.RATE_HZ), 1 / bus.RATE_HZ)
    seen = bus.rung(context, rho)
    name = f"link held, inertia ratio {rho:g}"
    sampled = f"{name}: damping ratio, bus with the drive's sampling"
    return [
        *ideal_and_bus(f"{name}: frequency", omega, exact.omega, seen.omega, "rad/s", 0.01),
        Comparison(f"{name}: damping ratio, ideal", zeta, exact.zeta, "", 0.03),
        Comparison(sampled, drive.zeta, seen.zeta, "", 0.03),
    ]
