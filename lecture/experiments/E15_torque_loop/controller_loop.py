"""The same torque feedback in the controller instead of the drive: 1 kHz, and a cycle late."""

from typing import Any

from limber_lecture import testbench as bench
from limber_lecture.context import Comparison, Context, ideal_and_bus
from limber_lecture.plants import growth
from limber_lecture.search import limit

from . import bus, ideal

K_HELD = 10.0  # N m/rad: little beside the spring, yet enough to set it swinging from 2 rad away
SOFT = 300.0  # N m/rad: a spring that allows a gain of 3
GAIN = 3.0
JUMP = [
    {"at_s": 1.7, "goal": {"joints_rad": [2.0], "duration_s": 0.1}},
    {"at_s": 1.77, "fault": {"joint": bench.JOINT, "kind": "drop_commands", "for_s": 0.015}},
]


def checks(context: Context, kappa: float, push: float) -> list[Comparison]:
    bound = ideal.most_ratio(1 / bench.CYCLE_S, 1) - 1
    name = "largest torque gain in the controller, link held"
    share = ideal.gained(1 + GAIN, kappa)
    gained = f"share of the torque, gain {GAIN:g} in the controller"
    gains = most_gain(), most_gain_bus(context, bound)
    shares = shared(kappa, push), shared_bus(context, kappa, push)
    return [
        *ideal_and_bus(name, bound, *gains, "", 0.05),
        *ideal_and_bus(gained, share, *shares, "", 0.01),
    ]


def most_gain() -> float:
    def settles(gain: float) -> bool:
        sensed = gain * bench.K_J + (1 + gain) * K_HELD
        return growth(bench.looped(bench.held_link(), [sensed, 0.0], bench.CYCLE_S, 1)) < 1.0

    return limit(settles, 0.01, 10.0)


def _law(K: float, D: float, gain: float) -> dict[str, Any]:
    return {"law": "full_state", **bench.given(K, D), "torque_gain": float(gain)}


def most_gain_bus(context: Context, expected: float) -> float:
    def growth(gain: float) -> float:
        damper = bench.joint(transmission={"damping_Nms_per_rad": 0.0})
        real = bench.joint(transmission={"damping_Nms_per_rad": bench.D_J})
        robot = {"changes": {"urdf": "held.urdf", **damper}, "plant_overrides": real}
        name, law = f"controller_limit_{gain:.3f}", _law(K_HELD, 0.0, gain)
        return bus.mode(bench.on_bus(context, name, law, JUMP, 2.5, **robot), 1.9, 2.5).growth

    tried = [0.85 * expected, 1.15 * expected]
    return bench.zero_between(tried, [growth(gain) for gain in tried])


def shared(kappa: float, push: float) -> float:
    """Torque that arrives over the law's own, u = -K θ, at rest under a push."""
    spring = [-(SOFT * GAIN), 0.0, SOFT * GAIN, 0.0]  # what the sensed torque is fed back by
    law = [0.0, 0.0, (1 + GAIN) * ideal.K, (1 + GAIN) * ideal.D]
    gains = [kappa * (a + b) for a, b in zip(spring, law, strict=True)]
    theta = bench.at_rest(bench.elastic(SOFT), gains, push)[2]
    return push / (ideal.K * float(theta))


def shared_bus(context: Context, kappa: float, push: float) -> float:
    law, name = _law(ideal.K, ideal.D, GAIN), "controller_share"
    return bus.share_of(bus.pushed(context, name, law, bench.sprung(SOFT), kappa, push))
