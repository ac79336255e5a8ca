"""The bench on its bus with each actuator, measured on what the joint really did."""

from typing import Any

from limber_lecture import testbench as bench
from limber_lecture.context import Context
from limber_lecture.ringdown import Mode, mode_seen
from limber_lecture.variants import friction

from .law import COULOMB_NM, GRAVITY, HORIZONTAL, HYDRAULIC, KAPPA, PUSH_NM, VOLTAGE_D

MOVE_S = 8.0


def _robot(gravity: float = 0.0, **actuator: Any) -> dict[str, Any]:
    change = {**bench.joint(**bench.RIGID), **bench.gravity(gravity)}
    return {**change, **bench.motor(actuator=actuator)} if actuator else change


def torque_constant(context: Context, K: float, D: float) -> tuple[float, float, float]:
    """Angle asked for, sag from it, and how far a push moves the joint from there."""
    log = bench.on_bus(
        context,
        f"torque_constant_{K:g}",
        bench.spring_damper(K, D),
        [bench.push(PUSH_NM, 4.0, 3.0, 0.5)],
        7.0,
        changes=_robot(GRAVITY),
        start_q=[HORIZONTAL],
        plant_overrides=bench.torque_constant(KAPPA),
    )
    rest = bench.mean(log, 3.0, 3.9)
    moved = bench.mean(log, 5.5, 6.4) - rest
    return float(bench.goal(log, 3.0, 3.9)[1].mean()), bench.lag(log, 3.0, 3.9), moved


def friction_lag(context: Context, K: float, D: float) -> float:
    """In the middle of a smooth motion, where nothing accelerates: mean over a stretch of it."""
    middle, end = 2.0 + MOVE_S / 2, 2.0 + MOVE_S
    goal = {"at_s": 2.0, "goal": {"joints_rad": [1.0], "duration_s": MOVE_S}}
    plant_overrides = bench.joint(friction=friction(COULOMB_NM))
    law, name = bench.spring_damper(K, D), f"friction_{K:g}"
    log = bench.on_bus(
        context, name, law, [goal], end, changes=_robot(), plant_overrides=plant_overrides
    )
    return bench.lag(log, middle - 0.5, middle + 0.5)


def rung(context: Context, name: str, K: float, D: float, **actuator: Any) -> Mode:
    """Pushed aside and let go."""
    push, changes = bench.push(5.0, 1.8, 0.7), _robot(**actuator)
    log = bench.on_bus(context, name, bench.spring_damper(K, D), [push], 4.5, changes=changes)
    seen = bench.truth(log, 2.51, 4.5)
    return mode_seen(seen["q"], seen["v"], every=5)


def most_stiffness(
    context: Context, name: str, D: float, tried: list[float], **actuator: Any
) -> float:
    """Stiffness at which a push neither dies out nor grows, between two that were tried."""

    def growth(K: float) -> float:
        law, push = bench.spring_damper(K, D), bench.push(10.0, 1.7, 0.02)
        changes = _robot(**actuator)
        log = bench.on_bus(context, f"{name}_{K:.0f}", law, [push], 2.4, changes=changes)
        seen = bench.truth(log, 1.8, 2.4)
        return mode_seen(seen["q"], seen["v"]).growth

    return bench.zero_between(tried, [growth(K) for K in tried])


def hydraulic() -> dict[str, Any]:
    return {
        "kind": "hydraulic",
        "fluid_stiffness_Nm_per_m3": HYDRAULIC.K_h,
        "leakage_m3_per_s_per_Nm": HYDRAULIC.c_l,
        "displacement_m3_per_rad": HYDRAULIC.D_h,
    }


def voltage_drive() -> dict[str, Any]:
    """k_e such that k_t k_e/R, at the joint, is the damping wanted."""
    motor = bench.motor_yaml()
    k_t = motor["gear_ratio"] * motor["rotor_torque_constant_Nm_per_A"]
    k_e = VOLTAGE_D * motor["phase_resistance_ohm"] / k_t
    return {"kind": "voltage_drive", "back_emf_Vs_per_rad": k_e}
