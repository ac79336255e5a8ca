"""Does the arm ring with the damping it was asked for?"""

from limber_lecture.context import Comparison, Context

from . import arm, constant, poses

TITLE = "Damping designed with the inertia gives every mode the ratio asked for"
CLAIM = "Damping can be chosen like stiffness: all knobs of the virtual spring, mass and damper"
SECTION = "2"
PLANT = "planar2r and ideal7, exact equations, pushed and let go; the damping design at 30 poses"
FAST = False


def run(context: Context) -> list[Comparison]:
    ratios = poses.damping_ratios(context)
    rung = {name: arm.cartesian(context, name) for name in (arm.PLANAR, arm.SEVEN)}
    salisbury = constant.runs(context)
    with context.picture(TITLE, columns=3, size=(16.5, 5.0)) as (left, middle, right):
        arm.draw(rung, left)
        poses.draw(ratios, middle)
        constant.draw(salisbury, right)
    return [*arm.checks(rung), *constant.checks(salisbury), *poses.checks(ratios)]
