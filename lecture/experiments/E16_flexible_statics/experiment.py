"""How stiff an elastic joint feels, and what a law that sees only the motor can do about it."""

from collections.abc import Iterator

from limber_lecture import testbench as bench
from limber_lecture.context import Comparison, Context, ideal_and_bus

from . import arm, drawing, iteration, joint

TITLE = "A spring in the joint adds its compliance, unless the law asks where the link will rest"
CLAIM = "Compliance built into the joint can neither be removed nor changed by the controller"
SECTION = "3.2"
PLANT = "one joint with a spring of 1000 N m/rad, and seven flexible joints: their equations"
PLANT += " (ideal), and robots with CiA 402 drives (bus)"
FAST = False

ON_MOTOR = "law on the motor, K = 500 N m/rad"
CONSTANT = "the same with constant gravity torque"
AT_REST = "law at rest of the link"


def run(context: Context) -> list[Comparison]:
    one = list(one_joint(context))
    seven = {
        position: (arm.predicted(position), arm.model(position), arm.measured(context, position))
        for position in (arm.ON_MOTOR, arm.AT_REST)
    }
    with context.picture(TITLE, columns=2, size=(13.5, 5.4)) as (left, right):
        drawing.one_joint(one, left)
        drawing.seven_joints(seven, right)
    return [
        *(check for found in one for check in found.checks()),
        *iteration.checks(context),
        *seven_checks(seven),
    ]


def one_joint(context: Context) -> Iterator[drawing.Stiffness]:
    gravity, D = joint.GRAVITY, joint.D
    motor = {**bench.spring_damper(joint.K, D), "position_feedback": "motor"}
    yield drawing.Stiffness(
        ON_MOTOR,
        joint.series(joint.K),
        joint.stiffness_model(joint.on_motor, 0.0, 0.0),
        joint.stiffness_bus(context, "on_motor", motor, 0.0),
    )
    tomei = {"law": "tomei", **bench.given(joint.K, D)}
    yield drawing.Stiffness(
        CONSTANT,
        joint.series(joint.K) + joint.gradient(),
        joint.stiffness_model(joint.tomei, gravity, joint.ANGLE),
        joint.stiffness_bus(context, "constant_gravity", tomei, gravity),
    )
    for K_d in joint.ASKED:
        gains = {**bench.spring_damper(K_d, D), "position_feedback": "static"}
        yield drawing.Stiffness(
            f"{AT_REST}, {K_d:g} N m/rad",
            K_d,
            joint.stiffness_model(joint.static(K_d), gravity, joint.ANGLE),
            joint.stiffness_bus(context, f"at_rest_{K_d:g}", gains, gravity),
        )


def seven_checks(found: dict[str, tuple]) -> list[Comparison]:
    names = {arm.ON_MOTOR: "law on the motors", arm.AT_REST: "law at rest of the links"}
    made = []
    for position, values_along in found.items():
        for i, axis in enumerate("xyz"):
            name = f"seven joints, {names[position]}: tip moved along {axis} by {arm.FORCE_N:g} N"
            values = (value[i] * 1e3 for value in values_along)
            made += ideal_and_bus(name, *values, "mm", 0.03)
    return made
