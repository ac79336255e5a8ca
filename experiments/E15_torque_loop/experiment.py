"""What a torque loop in the drive gives, and how much of it a rate allows."""

from limber.experiments import testbench as bench
from limber.experiments.check import Check
from limber.experiments.context import Context

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


def run(context: Context) -> list[Check]:
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


def effect_checks(found: drawing.Effect) -> list[Check]:
    """Lag and bias in their own units."""
    rho = found.rho
    lag = COULOMB_NM / ideal.K * 1e3
    made = []
    for how, (share, friction, bias) in (("ideal", found.ideal), ("bus", found.bus)):
        name = f"inertia ratio {rho:g}"
        gained = ideal.gained(rho, KAPPA)
        made += [
            Check(f"share of the torque, {name}, {how}", gained, share, "", 0.01),
            Check(f"friction lag, {name}, {how}", lag / rho, friction * lag, "mrad", 0.02),
            Check(
                f"torque made by a bias of {BIAS_NM:g} N m, {name}, {how}",
                (1 / rho - 1) * BIAS_NM,
                bias * BIAS_NM,
                "N m",
                0.01,
                "absolute",
            ),
        ]
    return sorted(made, key=lambda check: check.name.rpartition(",")[0])


def ring(context: Context, rho: float) -> list[Check]:
    """√(K_J ρ/B) and D_J/(2 √(K_J B/ρ)), link held."""
    omega = (rho * bench.K_J / bench.B) ** 0.5
    zeta = bench.D_J / (2 * (bench.K_J * bench.B / rho) ** 0.5)
    exact = bench.slowest(ideal.loop_with_rate(rho), ideal.FINE_S)
    drive = bench.slowest(ideal.loop_of_drive(rho, bus.RATE_HZ), 1 / bus.RATE_HZ)
    seen = bus.rung(context, rho)
    name = f"link held, inertia ratio {rho:g}"
    return [
        Check(f"{name}: frequency, ideal", omega, exact.omega, "rad/s", 0.01),
        Check(f"{name}: frequency, bus", omega, seen.omega, "rad/s", 0.01),
        Check(f"{name}: damping ratio, ideal", zeta, exact.zeta, "", 0.03),
        Check(
            f"{name}: damping ratio, bus with the drive's sampling", drive.zeta, seen.zeta, "", 0.03
        ),
    ]
