"""What actuators do wrong, under a soft law and under a stiff one."""

import numpy as np

from limber_lecture import testbench as bench
from limber_lecture.context import Comparison, Context, ideal_and_bus

from . import bus, drawing, ideal
from .law import HORIZONTAL, HYDRAULIC, INERTIA, LAGS_S, RING_D, SOFT, STIFF, VOLTAGE_D

TITLE = "What an actuator does wrong shows as torque over stiffness: a soft law hides nothing"
CLAIM = "Torque constant, rotor inertia, friction and current dynamics, which a stiff position loop"
CLAIM += " rejects, are no longer rejected"
SECTION = "3.1"
PLANT = "one rigid joint of 0.7 kg m²: its equations (ideal), and the test bench on its bus"
FAST = False

LEVELS = {"soft": SOFT, "stiff": STIFF}


def run(context: Context) -> list[Comparison]:
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
        self.ideal: drawing.Found = {name: {} for name in drawing.NAMES}
        self.bus: drawing.Found = {name: {} for name in drawing.NAMES}
        self.goal: dict[float, float] = {}
        for K, D in LEVELS.values():
            self.goal[K], sag, moved = bus.torque_constant(context, K, D)
            seen = moved, sag, bus.friction_lag(context, K, D)
            model = (
                ideal.deflection_model(K, D),
                ideal.sag_model(K, D, HORIZONTAL),
                ideal.friction_lag_model(K, D),
            )
            for name, on_bus, alone in zip(drawing.NAMES, seen, model, strict=True):
                self.bus[name][K], self.ideal[name][K] = on_bus, alone

    def checks(self) -> list[Comparison]:
        made = []
        for name in drawing.NAMES:
            for level, (K, _) in LEVELS.items():
                what = f"{name}, {level} (K = {K:g} N m/rad)"
                for where, q_d, found in (
                    ("ideal", HORIZONTAL, self.ideal),
                    ("bus", self.goal[K], self.bus),
                ):
                    values = drawing.predicted(name, K, q_d) * 1e3, found[name][K] * 1e3
                    made.append(Comparison(f"{what}, {where}", *values, "mrad", 0.01))
        return made


def rotor(context: Context) -> list[Comparison]:
    """√(K/(M + B)); the bus takes some damping, the frequency hardly changes."""
    K = SOFT[0]
    plant = bench.rigid(INERTIA)
    exact = bench.slowest(bench.looped(plant, [K, RING_D], ideal.FINE_S, 0), ideal.FINE_S)
    late = bench.slowest(bench.looped(plant, [K, RING_D], bench.CYCLE_S, 1), bench.CYCLE_S)
    seen = bus.rung(context, "rotor", K, RING_D)
    omega, name = np.sqrt(K / INERTIA), "frequency with the rotor, √(K/(M + B))"
    damping = "damping ratio with the rotor, bus with its delay"
    return [
        *ideal_and_bus(name, omega, exact.omega, seen.omega, "rad/s", 0.01),
        Comparison(damping, late.zeta, seen.zeta, "", 0.03),
    ]


def stiffness_limit(context: Context, lag: float) -> drawing.Limit:
    """K < D/τ_e; on the bus the same loop sampled and a cycle late."""
    D = SOFT[1]
    late = ideal.most_stiffness(D, lag, bench.CYCLE_S, 1)
    drive = {"kind": "current_drive", "lag_s": lag}
    name = f"lag_{lag * 1e3:.0f}ms"
    return drawing.Limit(
        f"most stiffness with a current loop of {lag * 1e3:.0f} ms",
        lag,
        formula=D / lag,
        ideal=ideal.most_stiffness(D, lag),
        late=late,
        bus=bus.most_stiffness(context, name, D, [0.9 * late, 1.1 * late], **drive),
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


def back_emf(context: Context) -> list[Comparison]:
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
        Comparison(f"{name}, ideal", VOLTAGE_D, damping[0], unit, 0.03),
        Comparison(f"{name}, bus with its delay", damping[1], damping[2], unit, 0.03),
    ]
