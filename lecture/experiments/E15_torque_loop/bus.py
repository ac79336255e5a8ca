"""The test bench with a torque loop in its drive, measured on what the joint really did."""

from typing import Any

from limber_lecture import testbench as bench
from limber_lecture.context import Context
from limber_lecture.ringdown import Mode, mode_seen
from limber_lecture.truth import Log
from limber_lecture.variants import friction

from .ideal import D, K

RATE_HZ = 10_000.0
STEP_S, COARSE_S = 1e-4, 2.5e-4  # s, of the simulated joint
MOVE_RAD, MOVE_S = 0.3, 6.0  # slow: nothing accelerates much
LAW = {**bench.spring_damper(K, D), "position_feedback": "motor"}
# Link held: 20 N m, from a goal that moves in 0.1 s. In its middle the drive hears nothing for
# 15 ms, less than its watchdog waits, and what it missed comes as a jump.
HELD_LAW = {**bench.spring_damper(1000.0, 0.0), "position_feedback": "link"}
JUMP = [
    {"at_s": 1.7, "goal": {"joints_rad": [0.02], "duration_s": 0.1}},
    {"at_s": 1.74, "fault": {"joint": bench.JOINT, "kind": "drop_commands", "for_s": 0.015}},
]


def _loop(rho: float, rate: float = RATE_HZ, samples: int = 0) -> dict[str, Any]:
    loop = {"inertia_ratio": float(rho), "rate_hz": rate, "delay_s": samples / rate}
    return {"torque_loop": loop}


def _jumped(context: Context, name: str, joint: dict[str, Any], end_s: float, step_s: float) -> Log:
    """The held joint after a jump of the torque asked for."""
    return bench.on_bus(
        context,
        name,
        HELD_LAW,
        JUMP,
        end_s,
        changes={"urdf": "held.urdf", **bench.joint(**joint)},
        step_s=step_s,
        plant_overrides=bench.joint(transmission={"damping_Nms_per_rad": bench.D_J}),
    )


def mode(log: Log, start_s: float, end_s: float) -> Mode:
    seen = bench.truth(log, start_s, end_s)
    deflection, rate = seen["theta"] - seen["q"], seen["theta_dot"] - seen["v"]
    return mode_seen(deflection, rate)


def rung(context: Context, rho: float) -> Mode:
    log = _jumped(context, f"ring_{rho:g}", _loop(rho), 2.1, STEP_S)
    return mode(log, 1.81, 1.95)


def most_ratio(context: Context, rate: float, samples: int, expected: float) -> float:
    """Inertia ratio at which the motor neither comes to rest nor swings more and more.

    The drive takes the joint for one without damper, so that it uses the sensed torque alone.
    """

    def growth(rho: float) -> float:
        joint = {**_loop(rho, rate, samples), "transmission": {"damping_Nms_per_rad": 0.0}}
        name = f"limit_{rate * 1e-3:g}kHz_{samples}_{rho:.2f}"
        log = _jumped(context, name, joint, 2.4, min(1 / rate, COARSE_S))
        return mode(log, 1.81, 2.4).growth

    tried = [1 + (expected - 1) * share for share in (0.85, 1.15)]
    return bench.zero_between(tried, [growth(rho) for rho in tried])


def pushed(
    context: Context,
    name: str,
    law: dict[str, Any],
    changes: dict[str, Any],
    kappa: float,
    push: float,
) -> Log:
    """The free joint with another torque constant than the drive believes in."""
    entries, plant_overrides = [bench.push(push, 2.0, 4.0, 0.5)], bench.torque_constant(kappa)
    real = {"changes": changes, "plant_overrides": plant_overrides}
    return bench.on_bus(context, name, law, entries, 5.4, **real, step_s=STEP_S)


def share_of(log: Log) -> float:
    """Torque on the link over what the law asked of the motor, at rest under the push."""
    asked = -K * (bench.mean(log, 4.5, 5.4, "theta") - bench.mean(log, 1.7, 1.99, "theta"))
    return bench.mean(log, 4.5, 5.4, "tau") / asked


def shared(context: Context, rho: float, kappa: float, push: float) -> float:
    return share_of(pushed(context, f"share_{rho:g}", LAW, bench.joint(**_loop(rho)), kappa, push))


def _free(context: Context, name: str, rho: float, entries: list, end_s: float, **real: Any) -> Log:
    """The free joint with something else about it than the drive believes."""
    robot = {"changes": bench.joint(**_loop(rho)), "plant_overrides": bench.joint(**real)}
    return bench.on_bus(context, name, LAW, entries, end_s, **robot, step_s=STEP_S)


def biased(context: Context, rho: float, bias: float) -> float:
    """Torque by which a biased sensor pushes the joint aside."""
    log = _free(context, f"bias_{rho:g}", rho, [], 4.0, torque_sensor={"bias_Nm": bias})
    return -K * bench.lag(log, 3.5, 4.0, "theta")


def friction_lag(context: Context, rho: float, coulomb: float) -> float:
    middle, end = 2.0 + MOVE_S / 2, 2.0 + MOVE_S
    goal = {"at_s": 2.0, "goal": {"joints_rad": [MOVE_RAD], "duration_s": MOVE_S}}
    log = _free(context, f"friction_{rho:g}", rho, [goal], end, friction=friction(coulomb))
    return bench.lag(log, middle - 0.5, middle + 0.5, "theta")
