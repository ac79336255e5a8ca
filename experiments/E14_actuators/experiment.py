"""What actuators do wrong, under a soft law and under a stiff one."""

import numpy as np

from limber.experiments import testbench as bench
from limber.experiments.check import Check
from limber.experiments.context import Context

from . import bus, drawing, ideal
from .law import HORIZONTAL, HYDRAULIC, INERTIA, LAGS_S, RING_D, SOFT, STIFF, VOLTAGE_D

TITLE = "What an actuator does wrong shows as torque over stiffness: a soft law hides nothing"
CLAIM = "Torque constant, rotor inertia, friction and current dynamics, which a stiff position loop"
CLAIM += " rejects, are no longer rejected"
SECTION = "3.1"
PLANT = "one rigid joint of 0.7 kg m²: its equations (ideal), and the test bench on its bus"
FAST = False

LEVELS = {"soft": SOFT, "stiff": STIFF}


def run(context: Context) -> list[Check]:
    errors = Errors(context)
    limits = [stiffness_limit(context, lag) for lag in LAGS_S]
    limits.append(hydraulic_limit(context))
    with context.picture(TITLE, columns=2, size=(13.5, 5.2)) as (left, right):
        drawing.errors(errors.ideal, errors.bus, left)
        drawing.limits(limits[:-1], right)
    return [
        *errors.checks(),
        *rotor(context),
        *(check for found in limits for check in found.checks()),
        *back_emf(context),
    ]


class Errors:
    """Angles by which torque constant and friction put the joint off, soft and stiff."""

    def __init__(self, context: Context) -> None:
        self.ideal: dict[str, dict[float, float]] = {name: {} for name in drawing.NAMES}
        self.bus: dict[str, dict[float, float]] = {name: {} for name in drawing.NAMES}
        self.goal: dict[float, float] = {}
        for K, D in LEVELS.values():
            goal, sag, moved = bus.torque_constant(context, K, D)
            self.goal[K] = goal
            self._store(self.bus, K, moved, sag, bus.friction_lag(context, K, D))
            self._store(
                self.ideal,
                K,
                ideal.deflection_model(K, D),
                ideal.sag_model(K, D, HORIZONTAL),
                ideal.friction_lag_model(K, D),
            )

    @staticmethod
    def _store(found: dict[str, dict[float, float]], K: float, *values: float) -> None:
        for name, value in zip(drawing.NAMES, values, strict=True):
            found[name][K] = value

    def checks(self) -> list[Check]:
        made = []
        for name in drawing.NAMES:
            for level, (K, _) in LEVELS.items():
                predicted = drawing.predicted(name, K, HORIZONTAL)
                on_bus = drawing.predicted(name, K, self.goal[K])
                what = f"{name}, {level} (K = {K:g} N m/rad)"
                made += [
                    _check(f"{what}, ideal", predicted, self.ideal[name][K], "mrad", 1e3),
                    _check(f"{what}, bus", on_bus, self.bus[name][K], "mrad", 1e3),
                ]
        return made


def _check(
    name: str, predicted: float, measured: float, unit: str, scale: float, tol: float = 0.01
) -> Check:
    return Check(name, predicted * scale, measured * scale, unit, tol)


def rotor(context: Context) -> list[Check]:
    """√(K/(M + B)); the bus takes some damping, the frequency hardly changes."""
    K = SOFT[0]
    plant = bench.rigid(INERTIA)
    exact = bench.slowest(bench.looped(plant, [K, RING_D], ideal.FINE_S, 0), ideal.FINE_S)
    late = bench.slowest(bench.looped(plant, [K, RING_D], bench.CYCLE_S, 1), bench.CYCLE_S)
    seen = bus.rung(context, "rotor", K, RING_D)
    name = "frequency with the rotor, √(K/(M + B))"
    return [
        Check(f"{name}, ideal", np.sqrt(K / INERTIA), exact.omega, "rad/s", 0.01),
        Check(f"{name}, bus", np.sqrt(K / INERTIA), seen.omega, "rad/s", 0.01),
        Check("damping ratio with the rotor, bus with its delay", late.zeta, seen.zeta, "", 0.03),
    ]


def stiffness_limit(context: Context, lag: float) -> drawing.Limit:
    """K < D/τ_e; on the bus the same loop sampled and a cycle late."""
    D = SOFT[1]
    late = ideal.most_stiffness(D, lag, bench.CYCLE_S, 1)
    tried = [0.9 * late, 1.1 * late]
    drive = {"kind": "current_drive", "lag_s": lag}
    name = f"lag_{lag * 1e3:.0f}ms"
    seen = bus.most_stiffness(context, name, D, tried, **drive)
    return drawing.Limit(
        f"most stiffness with a current loop of {lag * 1e3:.0f} ms",
        lag,
        formula=D / lag,
        ideal=ideal.most_stiffness(D, lag),
        late=late,
        bus=seen,
    )


def hydraulic_limit(context: Context) -> drawing.Limit:
    """(D + D_h/c_l) K_h c_l."""
    D = SOFT[1]
    late = ideal.most_stiffness_hydraulic(D, bench.CYCLE_S, 1)
    tried = [0.9 * late, 1.1 * late]
    return drawing.Limit(
        "most stiffness with a hydraulic cylinder",
        HYDRAULIC.lag,
        formula=(D + HYDRAULIC.damping) / HYDRAULIC.lag,
        ideal=ideal.most_stiffness_hydraulic(D),
        late=late,
        bus=bus.most_stiffness(context, "hydraulic", D, tried, **bus.hydraulic()),
    )


def back_emf(context: Context) -> list[Check]:
    """k_t k_e/R damps a joint that no law damps; 2 ζ ω (M + B) of its ring-down."""
    K = SOFT[0]
    exact = bench.slowest(bench.looped(ideal.winding(), [K, 0], ideal.FINE_S, 0), ideal.FINE_S)
    damped = bench.rigid(INERTIA, VOLTAGE_D)
    late = bench.slowest(bench.looped(damped, [K, 0.0], bench.CYCLE_S, 1), bench.CYCLE_S)
    seen = bus.rung(context, "voltage_drive", K, 0.0, **bus.voltage_drive())
    damping = [2 * mode.zeta * mode.omega * INERTIA for mode in (exact, late, seen)]
    name = "damping by a voltage drive, k_t k_e/R"
    unit = "N m s/rad"
    return [
        Check(f"{name}, ideal", VOLTAGE_D, damping[0], unit, 0.03),
        Check(f"{name}, bus with its delay", damping[1], damping[2], unit, 0.03),
    ]
